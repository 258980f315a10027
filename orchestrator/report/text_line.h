#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace mascot {

/// A line of the text summary.
template <class... Values>
std::string Line(fmt::format_string<Values...> format, Values&&... values) {
  return fmt::format(format, std::forward<Values>(values)...) + "\n";
}

}  // namespace mascot
