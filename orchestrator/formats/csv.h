#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/part_file.h"

namespace mascot {

// Tables as comma-separated values (RFC 4180, with lines that end in a line feed alone). Whatever writes or reads such
// a table in C++ does it by these.

/// A row with its line feed. A cell with a comma, a quote or a line break is in quotes, the quotes in it are doubled.
std::string CsvRow(std::span<const std::string> cells);
/// Takes the next row off `text`, as its cells. In quotes, commas and line breaks are of the cell. Rows that no program
/// should write, such as one with a quote inside a cell without quotes, are read as well as may be.
std::vector<std::string> TakeCsvRow(std::string_view& text);
/// As TakeCsvRow, of a table that somebody else wrote: lines may end in CR LF, and the last one without. Returns what
/// is wrong with the last of `cells`, "a quote in a cell without quotes"; empty: nothing.
std::string_view TakeForeignCsvRow(std::string_view& text, std::vector<std::string>& cells);
/// The cells of a row that stands alone, with or without its line feed.
inline std::vector<std::string> CsvCells(std::string_view row) { return TakeCsvRow(row); }
/// The beginning of `text` that is whole rows, each with its line feed.
std::string_view WholeCsvRows(std::string_view text);

/// Writes a table of numbers as comma-separated values below one line of column names. A double is written as the
/// shortest text that reads back as the same bits. Failures throw std::runtime_error; without Close() there is no file.
class CsvWriter {
 public:
  CsvWriter(const std::string& path, std::span<const std::string> columns);

  void Add(double value);
  void Add(std::int64_t value);
  void EndRow();
  void Close();

 private:
  template <class Number>
  void Put(Number value);
  void Flush();

  PartFile part_;
  OutputFile file_;
  std::string buffer_;
};

}  // namespace mascot
