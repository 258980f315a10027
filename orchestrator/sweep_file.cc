#include "orchestrator/sweep_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "experiment/section.h"
#include "orchestrator/bytes.h"
#include "orchestrator/input_file.h"
#include "orchestrator/output_file.h"
#include "orchestrator/part_file.h"
#include "orchestrator/worker_pool.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

/// A table may be long.
std::string ReadAll(const fs::path& path) {
  const InputFile file(path.string());
  Bytes bytes;
  file.Read(0, file.size(), bytes);
  return {bytes.begin(), bytes.end()};
}

/// In place of what is there, at once.
void Replace(const fs::path& path, const std::string& text) {
  PartFile part(path.string());
  OutputFile file(part.name());
  file.Write(AsBytes(text));
  file.SyncAndClose();
  part.Commit();
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

SweepFile::SweepFile(fs::path path, const Cells& columns, const std::string& plan, bool force)
    : path_(std::move(path)), header_(CsvLine(columns)) {
  const fs::path plan_path = path_.string() + ".plan";
  if (fs::exists(path_) && !force) {
    if (!fs::exists(plan_path) || ReadAll(plan_path) != plan)
      throw ConfigError({"--out " + path_.string() + ": expected a new file, or one of this very sweep, got another " +
                         "(--force begins anew)"});
    ReadRows(ReadAll(path_), header_);
  }
  WriteAll();  // first: rows never stand under another sweep's plan
  Replace(plan_path, plan);
  fd_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (fd_ < 0) throw std::runtime_error(path_.string() + ": cannot be opened: " + std::strerror(errno));
}

SweepFile::~SweepFile() {
  if (fd_ >= 0) ::close(fd_);
}

void SweepFile::ReadRows(const std::string& text, const std::string& header) {
  if (!text.starts_with(header))
    throw ConfigError({"--out " + path_.string() + ": expected the columns of this sweep, got others"});
  for (std::size_t begin = header.size(); begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end == text.npos) break;  // cut short
    const std::string line = text.substr(begin, end + 1 - begin);
    std::size_t run = 0;
    const auto [rest, error] = std::from_chars(line.data(), line.data() + line.size(), run);
    if (error != std::errc() || rest == line.data() + line.size() || *rest != ',')
      throw ConfigError({"--out " + path_.string() + ": expected rows that begin with a run's number, got '" +
                         line.substr(0, 40) + "'"});
    begin = end + 1;
    if (line.find("," + std::string(kLostProcess)) != line.npos) continue;  // it is flown again
    rows_.emplace(run, line);
  }
}

void SweepFile::WriteAll() const {
  std::string text = header_;
  for (const auto& [run, line] : rows_) text += line;
  Replace(path_, text);
}

void SweepFile::Add(std::size_t run, const Cells& cells) {
  Cells all{std::to_string(run)};
  all.insert(all.end(), cells.begin(), cells.end());
  const std::string line = CsvLine(all);
  if (!rows_.emplace(run, line).second) throw std::logic_error("run " + all[0] + " is in the table already");
  Append(line);
}

void SweepFile::Append(const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t wrote = ::write(fd_, line.data() + done, line.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0) throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
    done += static_cast<std::size_t>(wrote);
  }
}

void SweepFile::Sort() { WriteAll(); }

}  // namespace mascot
