#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace mascot {

/// The table that a sweep grows: CSV (RFC 4180), a line of column names, then a line for each run that is done, the
/// run's number first. Rows are appended whole as they come; after an interruption the next sweep of the same plan goes
/// on where this one ended, and a row that was cut short is dropped. Failures to write throw std::runtime_error.
class SweepFile {
 public:
  using Cells = std::vector<std::string>;

  /// Opens `path`, or begins it. `plan` says what is swept; it stands beside the table, in PATH.plan, and a table of
  /// another plan is refused with ConfigError, unless `force`, which begins anew.
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
  void ReadRows(const std::string& text, const std::string& header);
  void WriteAll() const;
  void Append(const std::string& line);

  std::filesystem::path path_;
  std::string header_;
  std::map<std::size_t, std::string> rows_;  // lines
  int fd_ = -1;
};

/// Cells as one line, with its end; quoted where they must be, without line breaks inside.
std::string CsvLine(const std::vector<std::string>& cells);

}  // namespace mascot
