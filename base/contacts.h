#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mascot {

/// The beginning of a contact.
struct Contact {
  static constexpr int kGround = 0;

  std::int64_t tick = 0;     ///< the contact began between this tick and the next
  int agent = 0;             ///< 1..N
  int other = kGround;       ///< another agent, with a larger id; kGround; -k: obstacle k, from 1 on
  double speed_m_per_s = 0;  ///< speed of the agent's centre relative to the other's, at that tick
};

/// A run reports this many contacts one by one, and only counts further ones.
inline constexpr std::size_t kMaxContactsTold = 256;

/// The contacts begun so far, by what an agent touched; a contact that lasts counts once.
struct Contacts {
  std::int64_t agents = 0;  ///< between two agents
  std::int64_t ground = 0;
  std::int64_t obstacles = 0;
  std::vector<Contact> first;  ///< the first kMaxContactsTold, in the order in which they began

  std::int64_t total() const { return agents + ground + obstacles; }
};

}  // namespace mascot
