#include "orchestrator/recording/run_folder.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <ctime>

#include "experiment/toml/section.h"
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

/// Files that a run writes. A recording under another name (record.file) is not listed: --force keeps it.
constexpr std::string_view kFiles[] = {
    "logs",         "config.toml",  "summary.json",     "states.npz",       "run.mcap",     "paths.png",
    "position.png", "velocity.png", "acceleration.png", "disagreement.png", "tracking.png", "error.png"};

void RemoveEarlierRun(const fs::path& path) {
  for (const auto& entry : fs::directory_iterator(path)) {
    const fs::path name = entry.path().filename();
    if (std::find(std::begin(kFiles), std::end(kFiles), name) != std::end(kFiles)) fs::remove_all(entry.path());
  }
}

fs::path MakeGiven(const std::string& out, bool force) {
  const fs::path path = out;
  if (fs::exists(path) && !fs::is_directory(path))
    throw ConfigError({"--out " + out + ": expected a folder, got a file"});
  if (fs::exists(path) && !fs::is_empty(path)) {
    if (!force)
      throw ConfigError(
          {"--out " + out +
           ": expected a new or empty folder, got one with files in it (--force writes there all the same)"});
    RemoveEarlierRun(path);
  }
  fs::create_directories(path);
  return path;
}

}  // namespace

RunFolder::RunFolder(const std::optional<std::string>& out, const std::string& name, bool force) try
    : path_(out ? MakeGiven(*out, force) : MakeNew(fs::path("runs") / name)) {
  fs::create_directories(path_ / "logs");
} catch (const fs::filesystem_error& error) {
  throw ConfigError({"--out: cannot make the run folder " + error.path1().string() + ": " + error.code().message()});
}

void RunFolder::Write(const std::string& name, const std::string& text) const { WriteWhole(File(name).string(), text); }

}  // namespace mascot
