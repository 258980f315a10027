#include "orchestrator/sweeping/table/table.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "base/number.h"
#include "experiment/toml/section.h"
#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/csv.h"
#include "orchestrator/formats/input_file.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "system/worker_pool.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

/// Reads a whole file of any size (ReadRegularFile has a limit).
std::string ReadAll(const fs::path& path) {
  const InputFile file(path.string());
  Bytes bytes;
  file.Read(0, file.size(), bytes);
  return {bytes.begin(), bytes.end()};
}

fs::path PlanOf(const fs::path& table) { return table.string() + ".plan"; }

[[noreturn]] void FailToRead(const fs::path& path) {
  throw std::runtime_error(path.string() + ": cannot be read: " + std::strerror(errno));
}

[[noreturn]] void FailToWrite(const fs::path& path) {
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
}

void Write(int fd, std::string_view text, const fs::path& path) {
  if (!WriteFully(fd, AsBytes(text))) FailToWrite(path);
}

/// Opens or creates the plan beside the table, and locks it. Returns its descriptor. Throws ConfigError if another
/// sweep has locked it. It is a POSIX record lock: worker processes do not inherit it, so that it ends with this
/// process.
int LockedPlan(const fs::path& table) {
  if (fs::exists(table) && !fs::is_regular_file(table))
    throw ConfigError({"--out " + table.string() + ": expected a file, got something else"});
  const fs::path path = PlanOf(table);
  const auto status = fs::symlink_status(path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw ConfigError({path.string() + ": expected the plan of a sweep, got something else than a file"});
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (fd < 0) throw std::runtime_error(path.string() + ": cannot be opened: " + std::strerror(errno));
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(fd, F_SETLK, &whole) == 0) return fd;
  const bool taken = errno == EACCES || errno == EAGAIN;
  ::close(fd);
  if (!taken) FailToWrite(path);
  throw ConfigError(
      {"--out " + table.string() + ": expected a table of this sweep's own, got one that another is writing"});
}

std::string OneLineOf(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

/// Whether a cell is one of those that a sweep writes below a metric.
bool IsValue(const std::string& cell) {
  return cell.empty() || cell == "true" || cell == "false" || NumberFrom<double>(cell);
}

/// What a row of a table must be.
class RowCheck {
 public:
  /// `plan`: what the runs set, if that is known.
  RowCheck(const std::vector<std::string>& columns, const SweepPlan* plan)
      : columns_(columns),
        plan_(plan),
        runs_(plan != nullptr ? plan->size() : kMaxRuns),
        error_(static_cast<std::size_t>(std::ranges::find(columns, kErrorColumn) - columns.begin())) {}

  /// The column with the first mistake, what was expected and what is there; empty: the row is right.
  std::string MistakeIn(const std::string& line, const std::vector<std::string>& cells) const {
    if (cells.size() != columns_.size()) return fmt::format("expected {} cells, got {}", columns_.size(), cells.size());
    const auto run = NumberFrom<std::size_t>(cells[0]);
    if (!run || *run >= runs_) return Mistake(0, fmt::format("a number of a run below {}", runs_), cells);
    if (plan_ != nullptr) {
      const SweepPoint point = (*plan_)[*run];
      for (std::size_t k = 0; k < point.overrides.size(); ++k)
        if (const std::string value = OneLineOf(point.overrides[k].value); cells[k + 1] != value)
          return Mistake(k + 1, fmt::format("{}, which run {} of this sweep has", value, *run), cells);
    }
    for (std::size_t k = error_ + 1; k < cells.size(); ++k)
      if (!IsValue(cells[k])) return Mistake(k, "a number, true, false or nothing", cells);
    return SweepRow(cells) == line + "\n"
               ? ""
               : "expected cells as a sweep writes them, got other quotes or a carriage return";
  }

 private:
  std::string Mistake(std::size_t k, const std::string& expected, const std::vector<std::string>& cells) const {
    constexpr std::size_t kLongest = 60;
    return fmt::format("{}: expected {}, got '{}'", columns_[k], expected, cells[k].substr(0, kLongest));
  }

  const std::vector<std::string>& columns_;
  const SweepPlan* plan_;
  std::size_t runs_, error_;
};

std::string ReadWhole(int fd) {
  std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(fd, 0, SEEK_END), 0)), '\0');
  const ssize_t got = ::pread(fd, text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return text;
}

void Overwrite(int fd, const std::string& text, const fs::path& path) {
  if (::ftruncate(fd, 0) != 0 || ::lseek(fd, 0, SEEK_SET) != 0) FailToWrite(path);
  Write(fd, text, path);
}

}  // namespace

std::string SweepRow(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = OneLineOf(std::move(cell));
  return CsvRow(cells);
}

fs::path FileBeside(fs::path table, std::string_view ending) {
  if (table.extension() == ".csv") table.replace_extension();
  return table += ending;
}

fs::path StatisticsBeside(const fs::path& table) { return FileBeside(table, ".stats.csv"); }

std::string PlanBeside(const fs::path& table) {
  const fs::path plan = PlanOf(table);
  return fs::is_regular_file(plan) ? ReadAll(plan) : "";
}

bool RowPlaces::Add(std::size_t run, std::uint64_t place) {
  if (Has(run)) return false;
  if (run >= places_.size()) places_.resize(run + 1);
  places_[run] = place;
  ++size_;
  return true;
}

void RowPlaces::ForEach(const std::function<void(std::size_t, std::uint64_t)>& take) const {
  for (std::size_t run = 0; run < places_.size(); ++run)
    if (Has(run)) take(run, places_[run]);
}

TableRows::TableRows(const fs::path& path, const Cells& columns, bool lost, const SweepPlan* plan) {
  if (fs::exists(path) && !fs::is_regular_file(path))  // the opening of a pipe would wait for somebody who writes to it
    throw std::runtime_error(path.string() + ": cannot be read: not a regular file");
  file_.open(path, std::ios::binary);
  std::string line;
  if (!file_) FailToRead(path);
  if (!std::getline(file_, line) || file_.eof() || line + "\n" != SweepRow(columns))
    throw ConfigError({path.string() + ": expected the columns of this sweep, got others"});
  const auto error = static_cast<std::size_t>(std::ranges::find(columns, kErrorColumn) - columns.begin());
  const RowCheck check(columns, plan);
  std::uint64_t place = line.size() + 1;
  for (std::size_t number = 2; std::getline(file_, line) && !file_.eof(); place += line.size() + 1, ++number) {
    const Cells cells = CsvCells(line);
    std::string mistake = check.MistakeIn(line, cells);
    const std::size_t run = NumberFrom<std::size_t>(cells[0]).value_or(0);
    const bool counts = lost || (mistake.empty() && !cells[error].starts_with(kLostProcess));
    if (mistake.empty() && counts && !places_.Add(run, place)) mistake = "run: " + EachOnce("run", std::to_string(run));
    if (!mistake.empty()) throw ConfigError({fmt::format("{}:{}: {}", path.string(), number, mistake)});
  }
  if (file_.bad()) FailToRead(path);
}

void TableRows::ForEach(const std::function<void(std::size_t, const std::string&)>& take) {
  std::string line;
  std::uint64_t at = 0;
  file_.clear();
  file_.seekg(0);
  places_.ForEach([&](std::size_t run, std::uint64_t place) {
    if (place != at) file_.seekg(static_cast<std::streamoff>(place));
    if (!std::getline(file_, line)) throw std::runtime_error("a table that was read has become shorter");
    at = place + line.size() + 1;
    take(run, line + "\n");
  });
}

SweepFile::SweepFile(fs::path path, const Cells& columns, const std::string& plan, bool force,
                     const Difference& difference, const SweepPlan* runs)
    : path_(fs::is_symlink(path) && fs::exists(path) ? fs::canonical(path) : std::move(path)),
      columns_(columns),
      plan_fd_(LockedPlan(path_)) {
  std::optional<TableRows> rows;
  if (fs::exists(path_) && !force && IsOfThisSweep(plan, difference))
    rows.emplace(path_, columns_, /*lost=*/false, runs);
  Rewrite(rows ? &*rows : nullptr);  // before the plan: rows must never be next to the plan of another sweep
  Overwrite(plan_fd_, plan, PlanOf(path_));
}

SweepFile::~SweepFile() {
  if (fd_ >= 0) ::close(fd_);
  if (plan_fd_ >= 0) ::close(plan_fd_);
}

/// Whether the table that is there has rows of this sweep. One without rows belongs to no sweep, and is replaced.
/// Throws ConfigError if it is another's.
bool SweepFile::IsOfThisSweep(const std::string& plan, const Difference& difference) const {
  const auto bytes = fs::file_size(path_);
  if (bytes == 0 || (bytes == SweepRow(columns_).size() && ReadAll(path_) == SweepRow(columns_))) return false;
  const std::string theirs = ReadWhole(plan_fd_);
  if (theirs == plan) return true;
  std::string why = "another, without the " + PlanOf(path_).filename().string() + " that says what it is of";
  if (theirs.empty()) {
    fs::remove(PlanOf(path_));  // it did not exist: LockedPlan created it
  } else {
    const std::string differs = difference ? difference(theirs) : "";
    if (difference && differs.empty()) return true;
    why = differs.empty() ? "another" : "another, which differs in " + differs;
  }
  throw ConfigError({"--out " + path_.string() + ": expected a new file, or one of this very sweep, got " + why +
                     " (--force begins anew)"});
}

/// Replaces the file by one with these rows, sorted; null: none.
void SweepFile::Rewrite(TableRows* rows) {
  WholeFile file(path_.string());
  const std::string header = SweepRow(columns_);
  file.Write(header);
  size_ = header.size();
  places_ = {};
  if (rows != nullptr)
    rows->ForEach([&](std::size_t run, const std::string& line) {
      file.Write(line);
      places_.Add(run, size_);
      size_ += line.size();
    });
  file.Commit();
  if (fd_ >= 0) ::close(fd_);
  fd_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (fd_ < 0) throw std::runtime_error(path_.string() + ": cannot be opened: " + std::strerror(errno));
}

void SweepFile::ForEachRow(const std::function<void(const Cells&)>& take) const {
  TableRows(path_, columns_, /*lost=*/true).ForEach([&](std::size_t /*run*/, const std::string& line) {
    take(CsvCells(line));
  });
}

void SweepFile::Add(std::size_t run, const Cells& cells) {
  Cells all{std::to_string(run)};
  all.insert(all.end(), cells.begin(), cells.end());
  AddLine(run, SweepRow(all));
}

void SweepFile::AddLine(std::size_t run, const std::string& line) {
  if (!places_.Add(run, size_)) throw std::logic_error(fmt::format("run {} is in the table already", run));
  Write(fd_, line, path_);
  size_ += line.size();
}

void SweepFile::Sort() {
  TableRows rows(path_, columns_, /*lost=*/true);
  Rewrite(&rows);
}

}  // namespace mascot
