#include "base/number_rows.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/number.h"
#include "base/utf8.h"

namespace mascot {
namespace {

constexpr double kLargestNumber = 1e6;
constexpr std::size_t kLongestQuote = 60;

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Appends the numbers of a line, at most `most`, with blanks around them. Returns at which character of the line there
/// is something else; nothing: there is nothing else.
std::optional<std::size_t> ReadRow(std::string_view line, std::size_t most, std::vector<double>& numbers) {
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin), end = std::min(comma, line.size());
    std::string_view cell = line.substr(begin, end - begin);
    const std::size_t at = begin + static_cast<std::size_t>(std::ranges::find_if_not(cell, IsBlank) - cell.begin());
    cell.remove_prefix(at - begin);
    while (!cell.empty() && IsBlank(cell.back())) cell.remove_suffix(1);
    const auto number = NumberFrom<double>(cell);
    if (!number || !(std::abs(*number) <= kLargestNumber) || numbers.size() == most) return at;
    numbers.push_back(*number);
    if (comma == line.npos) return std::nullopt;
    begin = comma + 1;
  }
}

}  // namespace

std::string ReadNumberRows(const std::string& text, std::span<const std::size_t> widths, std::string_view expected,
                           std::vector<NumberRow>& rows, TextPlace& place) {
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    place = {.line = ++number};
    if (std::ranges::all_of(line, IsBlank)) continue;
    NumberRow row{.line = number, .numbers = {}, .text = "'" + std::string(CutUtf8(line, kLongestQuote)) + "'"};
    auto wrong = ReadRow(line, widths.back(), row.numbers);
    if (wrong && rows.empty() && line.find_first_of("0123456789") == std::string::npos) continue;  // a heading
    if (!wrong && std::ranges::find(widths, row.numbers.size()) == widths.end()) wrong = line.size();
    if (wrong) {
      place.column = static_cast<int>(*wrong) + 1;
      return "expected " + std::string(expected) + ", got " + row.text;
    }
    rows.push_back(std::move(row));
  }
  place = {.line = std::max(number, 1)};
  return "";
}

}  // namespace mascot
