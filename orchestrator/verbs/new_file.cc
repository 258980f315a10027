#include "orchestrator/verbs/new_file.h"

#include "experiment/toml/section.h"

namespace mascot {

std::filesystem::path NewFile(const std::optional<std::string>& out, const std::string& name,
                              const std::string& recording, bool force) {
  namespace fs = std::filesystem;
  fs::path path = out ? fs::path(*out) : fs::path(recording).replace_filename(name);
  const auto refuse = [&](const std::string& why) {
    throw ConfigError({(out ? "--out " : "") + path.string() + ": expected " + why});
  };
  if (out && fs::is_directory(path)) path /= name;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!path.has_filename() || !fs::is_directory(folder)) refuse("a file in a folder that exists");
  if (fs::is_directory(path)) refuse("a file, got a folder");
  if (fs::exists(path) && fs::equivalent(path, recording)) refuse("another file than the recording");
  if (fs::exists(path) && !force) refuse("a new file, got one that exists (--force replaces it)");
  return path;
}

}  // namespace mascot
