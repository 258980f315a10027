#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace mascot::test {

/// So many bytes that no program makes much smaller, the same each time.
inline std::string Noise(std::size_t size) {
  std::string noise(size, '\0');
  std::uint64_t state = 1;
  for (char& one : noise) {
    state = (state * 1664525 + 1013904223) & 0xFFFFFFFF;
    one = static_cast<char>(state >> 24);
  }
  return noise;
}

}  // namespace mascot::test
