#pragma once

#include <cstdint>

namespace mascot {

/// Contacts of agents begun so far, by what they touched; one that lasts counts once.
struct Contacts {
  std::int64_t agents = 0;  ///< between two agents
  std::int64_t ground = 0;
  std::int64_t obstacles = 0;

  std::int64_t total() const { return agents + ground + obstacles; }
};

}  // namespace mascot
