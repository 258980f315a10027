#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace mascot {

/// "507 MB"; powers of ten, as file managers and disks have them.
inline std::string SizeText(std::uint64_t bytes) {
  double size = static_cast<double>(bytes);
  for (const char* unit : {"B", "kB", "MB"}) {
    const int digits = size < 9.95 && bytes >= 1000 ? 1 : 0;
    if (size < 999.5) return fmt::format("{:.{}f} {}", size, digits, unit);
    size /= 1000;
  }
  return fmt::format("{:.1f} GB", size);
}

}  // namespace mascot
