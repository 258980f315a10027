#include "orchestrator/sweeping/plan/plan_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "base/utf8.h"
#include "experiment/toml/section.h"
#include "orchestrator/formats/csv.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/values.h"

namespace mascot {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some spreadsheets write it
constexpr std::size_t kMaxMistakes = 20;                     // that are named
constexpr std::size_t kLongestCell = 60;                     // of a cell in a message, in bytes

std::string Quoted(std::string_view cell) { return "'" + Shortened(PlainLine(cell), kLongestCell) + "'"; }

std::string WithoutSpaces(const std::string& cell) {
  constexpr const char* kSpaces = " \t";
  const auto begin = cell.find_first_not_of(kSpaces);
  return begin == cell.npos ? "" : cell.substr(begin, cell.find_last_not_of(kSpaces) - begin + 1);
}

/// Whether text has the form of a dotted key. Which keys there are, the reader of the experiment knows.
bool IsLikeAKey(std::string_view text) {
  constexpr std::string_view kOthers = "_-.[]";
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || kOthers.find(c) != kOthers.npos;
  });
}

/// Reads a table from top to bottom, and notes its mistakes.
class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : rest_(text), table_{.name = PlainLine(name)} {
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  PlanTable Read() {
    if (const auto header = NextRow()) ReadHeader(*header);
    if (mistakes_.empty() && table_.keys.empty())
      Note(line_, 1, "expected column names, keys such as law.p_gain, got nothing");
    const bool is_header_right = mistakes_.empty();
    while (const auto row = is_header_right ? NextRow() : std::nullopt) ReadRow(*row);
    if (mistakes_.empty() && table_.rows.empty()) Note(line_, 1, "expected a row for each run, got none");
    if (mistakes_.size() > kMaxMistakes) {
      const std::size_t more = mistakes_.size() - kMaxMistakes;
      mistakes_.resize(kMaxMistakes);
      mistakes_.push_back(fmt::format("{}: {} more mistakes", table_.name, more));
    }
    if (!mistakes_.empty()) throw ConfigError(mistakes_);
    return std::move(table_);
  }

 private:
  void Note(std::size_t line, std::size_t column, const std::string& mistake) {
    mistakes_.push_back(fmt::format("{}:{}:{}: {}", table_.name, line, column, mistake));
  }

  /// The cells of the next line that is not blank; nothing at the end, and after quotes that are wrong, because what
  /// follows them has no certain cells.
  std::optional<std::vector<std::string>> NextRow() {
    while (!rest_.empty()) {
      std::vector<std::string> cells;
      line_ = next_line_;
      const std::string_view before = rest_;
      const std::string_view mistake = TakeForeignCsvRow(rest_, cells);
      const std::string_view taken = before.substr(0, before.size() - rest_.size());
      next_line_ += static_cast<std::size_t>(std::ranges::count(taken, '\n'));
      if (!mistake.empty()) {
        Note(line_, cells.size(),
             "expected quotes around a whole cell, and in it two for each one, got " + std::string(mistake));
        return std::nullopt;
      }
      for (std::string& cell : cells) cell = WithoutSpaces(cell);
      if (cells.size() > 1 || !cells[0].empty()) return cells;
    }
    return std::nullopt;
  }

  void ReadHeader(const std::vector<std::string>& keys) {
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const std::string& key = keys[k];
      const auto same = std::ranges::find_if(
          table_.keys, [&](const std::string& other) { return IsInside(key, other) || IsInside(other, key); });
      const bool has_others = key.find_first_of(";\t") != key.npos;
      if (!IsLikeAKey(key))
        Note(line_, k + 1,
             "expected a key such as law.p_gain, got " + (key.empty() ? "nothing" : Quoted(key)) +
                 (has_others ? " (commas separate cells)" : ""));
      else if (same != table_.keys.end())
        Note(line_, k + 1, "expected each key once, got " + key + (*same == key ? " again" : " and " + *same));
      table_.keys.push_back(key);
    }
  }

  void ReadRow(const std::vector<std::string>& cells) {
    if (cells.size() != table_.keys.size())
      return Note(line_, std::min(cells.size(), table_.keys.size() + 1),
                  fmt::format("expected {} cells, as there are keys, got {}", table_.keys.size(), cells.size()));
    PlanTable::Row row{.line = line_, .values = {}};
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::string& key = table_.keys[k];
      row.values.push_back(PlainValue(key, cells[k]));
      if (cells[k].empty())
        Note(line_, k + 1, key + ": expected a value, got nothing");
      else if (!IsOneValue(row.values.back()))
        Note(line_, k + 1, key + ": expected one value, got " + Quoted(cells[k]));
    }
    table_.rows.push_back(std::move(row));
  }

  std::string_view rest_;
  PlanTable table_;
  std::vector<std::string> mistakes_;
  std::size_t line_ = 1, next_line_ = 1;  // of the row that was read last, and of the next one
};

}  // namespace

PlanTable ReadPlanTable(std::string_view text, const std::string& name) { return Reader(text, name).Read(); }

}  // namespace mascot
