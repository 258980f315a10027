// A reader of CSV that takes nothing but what RFC 4180 allows, written apart from ours: every table that a program of
// ours writes must pass it.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// All rows of a table. Throws std::runtime_error, with the number of the byte, unless every row ends in a line feed
/// and has as many cells as the first, quotes stand around whole cells, and in these are doubled.
inline std::vector<std::vector<std::string>> StrictCsv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::size_t at = 0;
  const auto refuse = [&](std::string_view why) {
    throw std::runtime_error("byte " + std::to_string(at) + ": " + std::string(why));
  };
  const auto next = [&]() -> char {
    if (at == text.size()) refuse("the table ends amid a row");
    return text[at++];
  };
  while (at < text.size()) {
    std::vector<std::string>& row = rows.emplace_back();
    for (char end = ','; end == ',';) {
      std::string& cell = row.emplace_back();
      end = next();
      if (end == '"') {
        for (bool is_open = true; is_open;) {
          for (char c = next(); c != '"'; c = next()) cell += c;
          end = next();
          is_open = end == '"';
          if (is_open) cell += end;
        }
        if (end != ',' && end != '\n') refuse("a character behind a quote");
        continue;
      }
      for (; end != ',' && end != '\n'; end = next()) {
        if (end == '"' || end == '\r') refuse("a quote or a carriage return in a cell without quotes");
        cell += end;
      }
    }
    if (row.size() != rows.front().size()) refuse("a row of another number of cells");
  }
  return rows;
}

}  // namespace mascot
