#pragma once

#include <cstddef>
#include <string_view>

namespace mascot {

/// Columns of a terminal that everybody has.
inline constexpr std::size_t kTerminalWidth = 80;

/// Prints `label`, then `text` from column `indent` on, broken between words at kTerminalWidth. A label that is longer
/// has a line of its own.
void PrintWrapped(std::string_view label, std::string_view text, std::size_t indent);

}  // namespace mascot
