#include "orchestrator/recording/run_list.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/utf8.h"
#include "experiment/toml/section.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/run_folder.h"
#include "system/folder_lock.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestNote = 4096;

/// The text of a small file; empty if it cannot be read.
std::string TextOf(const fs::path& file) {
  try {
    return ReadRegularFile(file.string());
  } catch (const ConfigError&) {
    return "";
  }
}

std::string FirstLine(const std::string& text) { return PlainLine(text.substr(0, text.find('\n'))); }

std::string NameIn(const std::string& config) {
  try {
    Section run = Section::FromText(config, "config.toml").Child("run");
    const Value name = run.Free("name");
    if (const auto* text = std::get_if<std::string>(&name.data)) return PlainLine(*text);
  } catch (const ConfigError&) {  // it is being written, or damaged
  }
  return "";
}

std::uint64_t SizeOf(const fs::path& folder) {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;
    const auto size = entry->is_regular_file(gone) ? entry->file_size(gone) : 0;
    if (!gone) bytes += size;
  }
  return bytes;
}

bool IsAlive(const fs::path& folder) {
  try {
    return !FolderLock(folder).is_ours();
  } catch (const fs::filesystem_error&) {  // of another user, or on a file system without locks
    return false;
  }
}

ListedRun Describe(const fs::path& folder) {
  ListedRun run{.folder = folder.string(),
                .name = NameIn(TextOf(folder / "config.toml")),
                .written = std::chrono::file_clock::to_sys(WrittenAt(folder)),
                .bytes = SizeOf(folder),
                .sim_s = {},
                .exit = {},
                .is_alive = IsAlive(folder),
                .note = FirstLine(TextOf(folder / kNoteFile))};
  const auto summary = JsonOrNull<nlohmann::json>(TextOf(folder / "summary.json"));
  if (!summary.is_object()) return run;
  if (const auto found = summary.find("sim_s"); found != summary.end() && found->is_number())
    run.sim_s = found->get<double>();
  if (const auto found = summary.find("exit"); found != summary.end() && found->is_number_integer())
    run.exit = found->get<int>();
  return run;
}

void RequireRun(const std::string& folder) {
  if (!fs::is_directory(folder) || !IsARun(folder)) throw ConfigError({folder + ": expected a run folder"});
}

}  // namespace

std::vector<ListedRun> ListRuns(const std::string& folder) {
  if (!fs::is_directory(folder)) throw ConfigError({folder + ": expected a folder with runs"});
  std::vector<ListedRun> runs;
  for (const fs::path& path : RunsIn(folder)) runs.push_back(Describe(path));
  std::ranges::stable_sort(runs, std::ranges::greater(), &ListedRun::written);
  return runs;
}

void RemoveRun(const std::string& folder) {
  RequireRun(folder);
  RemoveRunFiles(folder);
  std::error_code not_empty;
  fs::remove(fs::path(folder) / "logs", not_empty);
  if (!fs::remove(folder, not_empty) || not_empty) return;
  fs::remove(fs::absolute(folder).lexically_normal().parent_path(), not_empty);  // runs/NAME
}

void NoteRun(const std::string& folder, const std::string& note) {
  RequireRun(folder);
  const fs::path file = fs::path(folder) / kNoteFile;
  if (note.size() > kLongestNote) throw ConfigError({"--note: expected at most 4096 letters"});
  if (note.empty())
    fs::remove(file);
  else
    WriteWhole(file.string(), PlainLine(note) + "\n");
}

}  // namespace mascot
