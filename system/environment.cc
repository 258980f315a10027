#include "system/environment.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

namespace mascot {

std::string EnvironmentText(const char* name) {
  const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets variables
  return text == nullptr ? "" : text;
}

std::string FindInPath(const std::string& program) {
  std::istringstream folders(EnvironmentText("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path path = std::filesystem::path(folder) / program;
    std::error_code unknown;
    if (std::filesystem::is_regular_file(path, unknown) && access(path.c_str(), X_OK) == 0) return path.string();
  }
  return "";
}

}  // namespace mascot
