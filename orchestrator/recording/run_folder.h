#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace mascot {

/// Where one run's results go: `runs/<name>/<time>/`, or what --out says.
class RunFolder {
 public:
  /// Makes the folder. Throws ConfigError if `out` exists and holds anything (unless `force`, which removes
  /// an earlier run's files from it), or cannot be made.
  RunFolder(const std::optional<std::string>& out, const std::string& name, bool force);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path File(const std::string& name) const { return path_ / name; }
  /// logs/<process>.log
  std::filesystem::path Log(const std::string& process) const { return path_ / "logs" / (process + ".log"); }
  /// Writes a file whole or not at all; throws std::runtime_error if that fails.
  void Write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

}  // namespace mascot
