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

/// Path of a file beside a table: with the ending ".png", sweep.png for sweep.csv. A name without the ending .csv is
/// kept whole: gain.v1.png for gain.v1.
std::filesystem::path FileBeside(std::filesystem::path table, std::string_view ending);
/// Path of the file with the statistics of a table: sweep.stats.csv for sweep.csv.
std::filesystem::path StatisticsBeside(const std::filesystem::path& table);
/// The text of TABLE.plan, which says which sweep a table is of; empty: there is no such file.
std::string PlanBeside(const std::filesystem::path& table);

/// Where the rows of a table begin in its file, in bytes, by the number of the run. Only this much of a table is in
/// memory.
class RowPlaces {
 public:
  bool Has(std::size_t run) const { return run < places_.size() && places_[run] != 0; }
  std::size_t size() const { return size_; }
  /// Has(run) must be true.
  std::uint64_t At(std::size_t run) const { return places_[run]; }
  /// Notes where the row of a run begins. Returns false, and notes nothing, if that run has a row already.
  bool Add(std::size_t run, std::uint64_t place);
  /// Calls `take` with each run and the place of its row, in order of the runs.
  void ForEach(const std::function<void(std::size_t run, std::uint64_t place)>& take) const;

 private:
  std::vector<std::uint64_t> places_;  // 0, where the column names stand: no row
  std::size_t size_ = 0;
};

/// The complete rows of a table that is only read.
class TableRows {
 public:
  using Cells = std::vector<std::string>;

  /// Reads where the rows are. `lost`: whether rows of runs whose process was lost count. `plan`: the sweep that the
  /// rows must be of; null: any. The last row may be incomplete: it does not count. Throws ConfigError if the file does
  /// not begin with the names of `columns`, and, naming line and column, if a row is none that a sweep writes, or is
  /// there twice; std::runtime_error if the file cannot be read.
  TableRows(const std::filesystem::path& path, const Cells& columns, bool lost, const SweepPlan* plan = nullptr);

  const RowPlaces& places() const { return places_; }
  /// Calls `take` with each row, as a line with its line break, in order of the runs. Throws std::runtime_error if the
  /// file has become shorter meanwhile.
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

  /// Says how the sweep of the table differs from this one. `theirs`: the text of its PATH.plan. Empty: not at all, it
  /// is only written in other words.
  using Difference = std::function<std::string(const std::string& theirs)>;
  /// Opens or creates the table at `path`. `plan` is text that identifies the sweep; it is stored in PATH.plan. `runs`:
  /// the plan itself. Throws ConfigError if the table has rows of another plan (with `force`, the table is emptied
  /// instead), if another sweep is writing it, or as TableRows does.
  SweepFile(std::filesystem::path path, const Cells& columns, const std::string& plan, bool force,
            const Difference& difference = {}, const SweepPlan* runs = nullptr);
  ~SweepFile();
  SweepFile(const SweepFile&) = delete;
  SweepFile& operator=(const SweepFile&) = delete;

  bool Has(std::size_t run) const { return places_.Has(run); }
  std::size_t rows() const { return places_.size(); }
  /// Calls `take` with the cells of each row, in order of the runs; the first cell is the number of the run.
  void ForEachRow(const std::function<void(const Cells&)>& take) const;
  /// Appends the row of a run; `cells` are those behind the number of the run. Throws std::logic_error if the run has a
  /// row already.
  void Add(std::size_t run, const Cells& cells);
  /// Appends the row of a run as another table has it. Throws as Add() does.
  void AddLine(std::size_t run, const std::string& line);
  /// Sorts the rows by run number. The file is replaced atomically.
  void Sort();

 private:
  bool IsOfThisSweep(const std::string& plan, const Difference& difference) const;
  void Rewrite(TableRows* rows);

  std::filesystem::path path_;
  Cells columns_;
  RowPlaces places_;
  std::uint64_t size_ = 0;  // bytes of the file
  int plan_fd_ = -1;        // descriptor of PATH.plan, locked while this object lives
  int fd_ = -1;             // descriptor of the table, at its end
};

/// A row of a table, or of its statistics, as one line of CSV. Line breaks in cells become spaces, because a row ends
/// where its line does.
std::string SweepRow(std::vector<std::string> cells);

}  // namespace mascot
