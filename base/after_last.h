#pragma once

#include <string_view>

namespace mascot {

/// What stands behind the last `separator` of `text`; all of it, if it has none.
inline std::string_view AfterLast(std::string_view text, char separator) {
  const std::size_t at = text.rfind(separator);
  return at == text.npos ? text : text.substr(at + 1);
}

}  // namespace mascot
