#include "bus/foreign_settings.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

extern char** environ;

namespace mascot {
namespace {

// What Fast DDS reads itself, and what the layer between ROS 2 and it (rmw_fastrtps) reads.
constexpr std::string_view kForeignSettings[] = {
    "FASTDDS_*",   // FASTDDS_DEFAULT_PROFILES_FILE, FASTDDS_ENVIRONMENT_FILE, FASTDDS_STATISTICS, ...
    "FASTRTPS_*",  // FASTRTPS_DEFAULT_PROFILES_FILE
    "RMW_*",       // RMW_IMPLEMENTATION, RMW_FASTRTPS_USE_QOS_FROM_XML, ...
    "ROS_DISCOVERY_SERVER",
    "ROS_SUPER_CLIENT",
    "ROS_LOCALHOST_ONLY",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
};

bool IsForeign(std::string_view name) {
  return std::ranges::any_of(kForeignSettings, [name](std::string_view setting) {
    return setting.ends_with('*') ? name.starts_with(setting.substr(0, setting.size() - 1)) : name == setting;
  });
}

}  // namespace

std::span<const std::string_view> ForeignSettings() { return kForeignSettings; }

void ForgetForeignSettings() {
  std::vector<std::string> names;
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    if (const auto name = text.substr(0, text.find('=')); IsForeign(name)) names.emplace_back(name);
  }
  for (const std::string& name : names) unsetenv(name.c_str());
  setenv("SKIP_DEFAULT_XML_FILE", "1", /*overwrite=*/1);  // Fast DDS: no profiles from the current folder
}

}  // namespace mascot
