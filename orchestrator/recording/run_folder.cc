#include "orchestrator/recording/run_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <stdexcept>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

std::string LocalTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d_%H-%M-%S", &local);
  return text;
}

/// A folder that did not exist before, even if another run starts within the same second.
fs::path MakeNew(const fs::path& parent) {
  fs::create_directories(parent);
  const std::string time = LocalTime();
  for (int n = 1;; ++n)
    if (const fs::path path = parent / (n == 1 ? time : time + "_" + std::to_string(n)); fs::create_directory(path))
      return path;
}

/// What runs write, but for a recording of another name: that is its owner's business.
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

void RunFolder::Write(const std::string& name, const std::string& text) const {
  const fs::path path = File(name);
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string() + ": " + std::strerror(errno));
}

}  // namespace mascot
