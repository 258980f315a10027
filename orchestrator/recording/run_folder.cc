#include "orchestrator/recording/run_folder.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "experiment/read_experiment.h"
#include "experiment/toml/section.h"
#include "idl/topics.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/formats/whole_file.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

std::string LocalTime() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%d_%H-%M-%S}", fmt::localtime(now));
}

/// Creates a new folder named after the time; with a suffix if another run starts within the same second.
fs::path MakeNew(const fs::path& parent) {
  fs::create_directories(parent);
  const std::string time = LocalTime();
  for (int n = 1;; ++n)
    if (const fs::path path = parent / (n == 1 ? time : time + "_" + std::to_string(n)); fs::create_directory(path))
      return path;
}

/// Files that a run writes, beside its recording, its pictures and its logs.
constexpr std::string_view kFiles[] = {"config.toml",   "summary.json", "events.csv",
                                       "law_curve.csv", "states.npz",   kNoteFile};
/// Pictures of a run (scripts/pictures.py), and the formats in which `plot` draws them.
constexpr std::string_view kPictures[] = {"paths", "position", "velocity", "acceleration", "disagreement", "curve",
                                          "error", "tracking", "graph",    "safety",       "incidents"};
constexpr std::string_view kPictureFormats[] = {".png", ".pdf", ".svg", ".pgf", ".csv"};

/// True for regular files only: not for links to them, not for folders.
bool IsFile(const fs::path& path) { return fs::is_regular_file(fs::symlink_status(path)); }

bool IsRecording(const fs::path& path) {
  try {
    return path.extension() == ".mcap" && IsFile(path) && IsByMcapWriter(path.string());
  } catch (const std::runtime_error&) {  // it cannot be read
    return false;
  }
}

/// Whether this is a config.toml as a run writes it: resolved, with the format first.
bool IsResolved(const fs::path& config) {
  constexpr std::string_view kBeginning = "format = ";
  std::string text(kBeginning.size(), '\0');
  return IsFile(config) && std::ifstream(config, std::ios::binary).read(text.data(), std::ssize(text)) &&
         text == kBeginning;
}

/// Whether a run has made the folder: it wrote its config.toml and began a recording.
bool IsOfARun(const fs::path& folder) {
  return IsResolved(folder / "config.toml") && std::ranges::any_of(fs::directory_iterator(folder), IsRecording);
}

bool IsLogName(const fs::path& name) {
  const std::string process = name.stem().string();
  return name.extension() == ".log" &&
         (process == "orchestrator" || process == "physics_server" || process == "viewers" ||
          AgentsOf(process).has_value() || VehicleOf(process).has_value());
}

/// What there is in the folder by a name that a run gives, relative to it.
std::vector<fs::path> NamesOfARun(const fs::path& folder, const std::string& recording) {
  std::vector<fs::path> names;
  const auto add = [&](const fs::path& name) {
    if (fs::exists(fs::symlink_status(folder / name))) names.push_back(name);
  };
  for (const std::string_view file : kFiles)
    for (const char* suffix : {"", ".part"}) add(std::string(file) + suffix);
  for (const std::string_view picture : kPictures)
    for (const std::string_view format : kPictureFormats)
      for (const char* suffix : {"", ".part"}) add(std::string(picture).append(format) + suffix);
  for (const std::string& file : std::set<std::string>{recording, "run.mcap"}) add(file);
  const fs::file_status logs = fs::symlink_status(folder / "logs");
  if (fs::exists(logs) && !fs::is_directory(logs)) names.emplace_back("logs");
  if (fs::is_directory(logs))
    for (const fs::path& log : fs::directory_iterator(folder / "logs"))
      if (IsLogName(log.filename())) names.push_back("logs" / log.filename());
  std::ranges::sort(names);
  return names;
}

/// Removes the files of a run. `where`, `hint`: how a message begins and ends. Throws ConfigError, and removes nothing,
/// if something has the name of such a file and is none.
void RemoveFiles(const fs::path& folder, const std::string& recording, const std::string& where,
                 const std::string& hint) {
  const bool of_a_run = IsOfARun(folder);
  const std::vector<fs::path> names = NamesOfARun(folder, recording);
  std::string others;
  for (const fs::path& name : names) {
    const fs::path path = folder / name;
    if (of_a_run && IsFile(path) && (name.extension() != ".mcap" || IsRecording(path))) continue;
    others += (others.empty() ? "" : ", ") + name.string();
  }
  if (!others.empty())
    throw ConfigError(
        {where + ": expected the files of an earlier run, got " + others + ", which no run has made" + hint});
  for (const fs::path& name : names) fs::remove(folder / name);
}

fs::path MakeGiven(const std::string& out, const RunFolder::Words& words) {
  const fs::path path = out;
  if (fs::exists(path) && !fs::is_directory(path))
    throw ConfigError({words.out + " " + out + ": expected a folder, got a file"});
  fs::create_directories(path);
  return path;
}

/// Throws ConfigError if there is something in the folder; with `force`, if it is not of a run, which is removed.
void Empty(const fs::path& folder, const std::string& recording, bool force, const RunFolder::Words& words) {
  if (fs::is_empty(folder)) return;
  const std::string where = words.out + " " + folder.string();
  if (!force)
    throw ConfigError(
        {fmt::format("{}: expected a new or empty folder, got one with files in it ({} replaces those of "
                     "an earlier run, and keeps others)",
                     where, words.force)});
  RemoveFiles(folder, recording, where, " (" + words.force + " replaces nothing else)");
}

/// "the run 'name'", by its config.toml.
std::string NameOfRun(const fs::path& folder) {
  try {
    Section document = Section::FromText(ReadRegularFile((folder / "config.toml").string()), "config.toml");
    document.Use(ExperimentKeys());
    Section run = document.Child("run");
    if (run.Has("name")) return "the run '" + run.Text("name") + "'";
  } catch (const std::exception&) {  // it is being written
  }
  return "a run";
}

/// Throws ConfigError if another run writes to the folder. `words`: the folder, as the message begins.
FolderLock Lock(const fs::path& folder, const std::string& words) {
  FolderLock lock(folder);
  if (lock.is_ours()) return lock;
  const pid_t holder = lock.Holder();
  throw ConfigError({fmt::format("{}: expected a folder to which no run is writing, got that of {}{}", words,
                                 NameOfRun(folder), holder > 0 ? fmt::format(" (process {})", holder) : "")});
}

/// The recording in a folder, by its name; "run.mcap" if there is none, or are several.
std::string NameOfRecording(const fs::path& folder) {
  std::vector<std::string> found;
  for (const fs::path& path : fs::directory_iterator(folder))
    if (IsRecording(path)) found.push_back(path.filename().string());
  return found.size() == 1 ? found.front() : "run.mcap";
}

}  // namespace

RunFolder::RunFolder(const std::optional<std::string>& out, const Experiment& experiment, bool force,
                     const Words& words) try
    : path_(out ? MakeGiven(*out, words) : MakeNew(fs::path("runs") / experiment.run.name)),
      lock_(Lock(path_, words.out + " " + path_.string())) {
  if (out) Empty(path_, experiment.record.file, force, words);
  fs::create_directories(path_ / "logs");
} catch (const fs::filesystem_error& error) {
  throw ConfigError(
      {words.out + ": cannot make the run folder " + error.path1().string() + ": " + error.code().message()});
}

std::vector<std::string> PicturesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const std::string_view picture : kPictures)
    for (const char* format : {".png", ".svg"})
      if (const std::string name = std::string(picture) + format; IsFile(folder / name)) {
        names.push_back(name);
        break;
      }
  return names;
}

void RemoveRunFiles(const fs::path& folder) {
  const FolderLock lock = Lock(folder, folder.string());
  RemoveFiles(folder, NameOfRecording(folder), folder.string(), "");
}

void RunFolder::Write(const std::string& name, const std::string& text) const { WriteWhole(File(name).string(), text); }

}  // namespace mascot
