#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mascot {

/// `text`, `times` times in a row: makes input that is nested deeply.
inline std::string Repeated(std::size_t times, std::string_view text) {
  std::string all;
  for (; times > 0; --times) all += text;
  return all;
}

}  // namespace mascot
