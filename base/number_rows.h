#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// A line of a table of numbers.
struct NumberRow {
  int line = 0;  ///< from 1
  std::vector<double> numbers;
  std::string text;  ///< the line, as a message quotes it: 'a,b,...
};

/// A place in a text; both count from 1.
struct TextPlace {
  int line = 1, column = 1;
};

/// Reads lines of numbers in [-1e+06, 1e+06] with commas between them, as many in each as one of `widths`, which
/// ascend. Blank lines are skipped, and so is a first line without a digit: a heading. Returns an empty text if all was
/// read; else the mistake ("expected " + `expected` + ", got ...") and, in `place`, where it is.
std::string ReadNumberRows(const std::string& text, std::span<const std::size_t> widths, std::string_view expected,
                           std::vector<NumberRow>& rows, TextPlace& place);

}  // namespace mascot
