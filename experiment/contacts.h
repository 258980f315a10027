#pragma once

#include <cstdint>

namespace mascot {

/// Number of contacts begun so far, by what an agent touched; a contact that lasts counts once.
struct Contacts {
  std::int64_t agents = 0;  ///< between two agents
  std::int64_t ground = 0;
  std::int64_t obstacles = 0;

  std::int64_t total() const { return agents + ground + obstacles; }
};

}  // namespace mascot
