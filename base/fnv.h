#pragma once

#include <cstdint>
#include <string_view>

namespace mascot {

/// The hash of Fowler, Noll and Vo of a text (FNV-1a, 64 bits): the same in every program and on every processor. It
/// does not withstand whoever wants two texts of one hash.
constexpr std::uint64_t Fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char character : text) hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3;
  return hash;
}

}  // namespace mascot
