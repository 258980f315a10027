#include "system/processes.h"

#include <filesystem>
#include <system_error>

#include "base/number.h"

namespace mascot {

std::vector<pid_t> Processes() {
  namespace fs = std::filesystem;
  std::vector<pid_t> processes;
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error))
    if (const auto process = NumberFrom<pid_t>(entry->path().filename().native())) processes.push_back(*process);
  return processes;
}

}  // namespace mascot
