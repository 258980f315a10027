#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

class SweepPlan;

/// Name of the column with the error of a run; its cell is empty if the run did not fail.
inline constexpr const char* kErrorColumn = "error";

/// A file beside a table: sweep.png with the ending ".png" of sweep.csv. Of a table without the ending .csv the whole
/// name stays: gain.v1.png of gain.v1.
std::filesystem::path FileBeside(std::filesystem::path table, std::string_view ending);
/// The file with the statistics of a table: sweep.stats.csv of sweep.csv.
std::filesystem::path StatisticsBeside(const std::filesystem::path& table);
/// The text beside a table that says what it is of, in TABLE.plan; empty: there is none.
std::string PlanBeside(const std::filesystem::path& table);

/// Where the rows of a table stand in its file, by the number of the run. Only this much of a table is in memory.
class RowPlaces {
 public:
  bool Has(std::size_t run) const { return run < places_.size() && places_[run] != 0; }
  std::size_t size() const { return size_; }
  /// Has(run) must be true.
  std::uint64_t At(std::size_t run) const { return places_[run]; }
  /// False if it has that run.
  bool Add(std::size_t run, std::uint64_t place);
  /// Hands over each run and its place, by the number of the run.
  void ForEach(const std::function<void(std::size_t run, std::uint64_t place)>& take) const;

 private:
  std::vector<std::uint64_t> places_;  // 0, where the column names stand: no row
  std::size_t size_ = 0;
};

/// The complete rows of a table that is only read.
class TableRows {
 public:
  using Cells = std::vector<std::string>;

  /// `lost`: also runs whose process was lost. `plan`: the sweep that the rows must be of; null: any. Throws
  /// ConfigError, naming line and column, if the file does not begin with the names of `columns`, or a row is none that
  /// a sweep writes, or is there twice; std::runtime_error if it cannot be read. The last row may be incomplete.
  TableRows(const std::filesystem::path& path, const Cells& columns, bool lost, const SweepPlan* plan = nullptr);

  const RowPlaces& places() const { return places_; }
  /// Hands over each row, with its line break, by the number of the run.
  void ForEach(const std::function<void(std::size_t run, const std::string& line)>& take);

 private:
  std::ifstream file_;
  RowPlaces places_;
};

/// Table of a sweep: CSV (RFC 4180) with a line of column names, then one line per finished run, which begins with the
/// number of the run. Rows are appended as runs finish. After an interruption, the next sweep with the same plan
/// continues the table; an incomplete last row is dropped, and runs whose process was lost are executed again. Failures
/// to write throw std::runtime_error.
class SweepFile {
 public:
  using Cells = std::vector<std::string>;

  /// Opens or creates the table at `path`. `plan` is text that identifies the sweep; it is stored beside the table, in
  /// PATH.plan. Throws ConfigError if the table has rows of another plan (with `force`, these are replaced instead), or
  /// if another sweep is writing it, or as TableRows does. `runs`: the plan itself. `difference` says in what the plan
  /// beside the table differs from this one; empty: it is the same in other words.
  using Difference = std::function<std::string(const std::string& theirs)>;
  SweepFile(std::filesystem::path path, const Cells& columns, const std::string& plan, bool force,
            const Difference& difference = {}, const SweepPlan* runs = nullptr);
  ~SweepFile();
  SweepFile(const SweepFile&) = delete;
  SweepFile& operator=(const SweepFile&) = delete;

  bool Has(std::size_t run) const { return places_.Has(run); }
  std::size_t rows() const { return places_.size(); }
  /// Hands over the cells of each row, by the number of the run, which is the first cell.
  void ForEachRow(const std::function<void(const Cells&)>& take) const;
  /// Appends the row of a run; `cells` without the run number.
  void Add(std::size_t run, const Cells& cells);
  /// Appends the row of a run as it stands in another table.
  void AddLine(std::size_t run, const std::string& line);
  /// Sorts the rows by run number. The file is replaced atomically.
  void Sort();

 private:
  bool IsOfThisSweep(const std::string& plan, const Difference& difference) const;
  void Rewrite(TableRows* rows);

  std::filesystem::path path_;
  Cells columns_;
  RowPlaces places_;
  std::uint64_t size_ = 0;  // of the file
  int plan_fd_ = -1;        // PATH.plan, locked while this object lives
  int fd_ = -1;             // of the table, at its end
};

/// A row of the table, or of its statistics: of one line, for it ends where its line does. Line breaks in cells become
/// spaces.
std::string SweepRow(std::vector<std::string> cells);

}  // namespace mascot
