#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// The column of a run's failure; empty: none.
inline constexpr const char* kErrorColumn = "error";

/// The table that a sweep grows: CSV (RFC 4180), a line of column names, then a line for each run that is done, the
/// run's number first. Rows are appended whole as they come; after an interruption the next sweep of the same plan goes
/// on where this one ended, and a row that was cut short is dropped. Failures to write throw std::runtime_error.
class SweepFile {
 public:
  using Cells = std::vector<std::string>;

  /// Opens `path`, or begins it. `plan` says what is swept; it stands beside the table, in PATH.plan, and a table with
  /// rows of another plan is refused with ConfigError, unless `force`, which begins anew; so is one that another sweep
  /// is writing.
  SweepFile(std::filesystem::path path, const Cells& columns, const std::string& plan, bool force);
  ~SweepFile();
  SweepFile(const SweepFile&) = delete;
  SweepFile& operator=(const SweepFile&) = delete;

  bool Has(std::size_t run) const { return rows_.contains(run); }
  std::size_t rows() const { return rows_.size(); }
  void Add(std::size_t run, const Cells& cells);
  /// Puts the rows in order of their numbers. The file is whole at any moment.
  void Sort();

 private:
  void GoOn(const std::string& text, const std::string& plan);
  void ReadRows(const std::string& text);
  void WriteAll() const;

  std::filesystem::path path_;
  std::string header_;
  std::map<std::size_t, std::string> rows_;  // lines
  int plan_fd_ = -1;                         // locked as long as we write the table
  int fd_ = -1;
};

/// Cells as one line, with its end; quoted where they must be, without line breaks inside.
std::string CsvLine(const std::vector<std::string>& cells);
/// The cells of such a line.
std::vector<std::string> CsvCells(std::string_view line);

}  // namespace mascot
