#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// Name of the column with the error of a run; its cell is empty if the run did not fail.
inline constexpr const char* kErrorColumn = "error";

/// Table of a sweep: CSV (RFC 4180) with a line of column names, then one line per finished run, which begins with the
/// number of the run. Rows are appended as runs finish. After an interruption, the next sweep with the same plan
/// continues the table; an incomplete last row is dropped. Failures to write throw std::runtime_error.
class SweepFile {
 public:
  using Cells = std::vector<std::string>;

  /// Opens or creates the table at `path`. `plan` is text that identifies the sweep; it is stored beside the table, in
  /// PATH.plan. Throws ConfigError if the table has rows of another plan (with `force`, these are replaced instead), or
  /// if another sweep is writing it.
  SweepFile(std::filesystem::path path, const Cells& columns, const std::string& plan, bool force);
  ~SweepFile();
  /// The plan beside the table at `path`; empty: there is none.
  static std::string PlanBeside(const std::filesystem::path& path);
  SweepFile(const SweepFile&) = delete;
  SweepFile& operator=(const SweepFile&) = delete;

  bool Has(std::size_t run) const { return rows_.contains(run); }
  std::size_t rows() const { return rows_.size(); }
  /// Hands over the cells of each row, by the number of the run, which is the first cell.
  void ForEachRow(const std::function<void(const Cells&)>& take) const;
  /// Appends the row of a run; `cells` without the run number.
  void Add(std::size_t run, const Cells& cells);
  /// Sorts the rows by run number. The file is replaced atomically.
  void Sort();

 private:
  void Resume(const std::string& text, const std::string& plan);
  void ReadRows(const std::string& text);
  void WriteAll() const;

  std::filesystem::path path_;
  std::string header_;
  std::map<std::size_t, std::string> rows_;  // line of each run
  int plan_fd_ = -1;                         // PATH.plan, locked while this object lives
  int fd_ = -1;
};

/// Joins cells to a CSV line with its line break. Cells are quoted where necessary; line breaks in them become spaces.
std::string CsvLine(const std::vector<std::string>& cells);
/// Splits a CSV line into its cells.
std::vector<std::string> CsvCells(std::string_view line);

}  // namespace mascot
