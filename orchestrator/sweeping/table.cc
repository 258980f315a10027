#include "orchestrator/sweeping/table.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "experiment/toml/section.h"
#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/input_file.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/processes/worker_pool.h"

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
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
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

std::string CsvLine(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    std::string text = cell;
    std::ranges::replace_if(
        text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    if (text.find_first_of(",\"") == std::string::npos) {
      line += text;
      continue;
    }
    line += '"';
    for (const char c : text) line.append(c == '"' ? 2 : 1, c);
    line += '"';
  }
  return line + "\n";
}

std::vector<std::string> CsvCells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size() && (quoted || line[i] != '\n'); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += line[i];
  }
  return cells;
}

SweepFile::SweepFile(fs::path path, const Cells& columns, const std::string& plan, bool force)
    : path_(fs::is_symlink(path) && fs::exists(path) ? fs::canonical(path) : std::move(path)),
      header_(CsvLine(columns)),
      plan_fd_(LockedPlan(path_)) {
  if (fs::exists(path_) && !force) Resume(ReadAll(path_), plan);
  WriteAll();  // before the plan: rows must never be next to the plan of another sweep
  Overwrite(plan_fd_, plan, PlanOf(path_));
  fd_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (fd_ < 0) throw std::runtime_error(path_.string() + ": cannot be opened: " + std::strerror(errno));
}

std::string SweepFile::PlanBeside(const fs::path& path) {
  const fs::path plan = PlanOf(path);
  return fs::is_regular_file(plan) ? ReadAll(plan) : "";
}

SweepFile::~SweepFile() {
  if (fd_ >= 0) ::close(fd_);
  if (plan_fd_ >= 0) ::close(plan_fd_);
}

/// Continues an existing table, whose contents are `text`. A table without rows belongs to no sweep and is replaced.
void SweepFile::Resume(const std::string& text, const std::string& plan) {
  if (text.empty() || text == header_) return;
  const std::string theirs = ReadWhole(plan_fd_);
  if (theirs != plan) {
    if (theirs.empty()) fs::remove(PlanOf(path_));  // it did not exist: LockedPlan created it
    throw ConfigError({"--out " + path_.string() + ": expected a new file, or one of this very sweep, got another " +
                       "(--force begins anew)"});
  }
  if (!text.starts_with(header_))
    throw ConfigError({"--out " + path_.string() + ": expected the columns of this sweep, got others"});
  ReadRows(text);
}

/// Reads the complete rows. A run whose process was lost is left out, so that it is executed again.
void SweepFile::ReadRows(const std::string& text) {
  const Cells columns = CsvCells(header_);
  const auto error = static_cast<std::size_t>(std::ranges::find(columns, kErrorColumn) - columns.begin());
  for (std::size_t begin = header_.size(); begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end == text.npos) break;  // incomplete row
    const std::string line = text.substr(begin, end + 1 - begin);
    begin = end + 1;
    const Cells cells = CsvCells(line);
    std::size_t run = 0;
    const auto [rest, wrong] = std::from_chars(cells[0].data(), cells[0].data() + cells[0].size(), run);
    const bool whole =
        wrong == std::errc() && rest == cells[0].data() + cells[0].size() && cells.size() == columns.size();
    if (whole && !cells[error].starts_with(kLostProcess)) rows_.emplace(run, line);
  }
}

void SweepFile::ForEachRow(const std::function<void(const Cells&)>& take) const {
  for (const auto& [run, line] : rows_) take(CsvCells(line));
}

void SweepFile::WriteAll() const {
  WholeFile file(path_.string());
  file.Write(header_);
  for (const auto& [run, line] : rows_) file.Write(line);
  file.Commit();
}

void SweepFile::Add(std::size_t run, const Cells& cells) {
  Cells all{std::to_string(run)};
  all.insert(all.end(), cells.begin(), cells.end());
  const std::string line = CsvLine(all);
  if (!rows_.emplace(run, line).second) throw std::logic_error("run " + all[0] + " is in the table already");
  Write(fd_, line, path_);
}

void SweepFile::Sort() { WriteAll(); }

}  // namespace mascot
