#include "system/control_groups.h"

#include <sched.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace mascot {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<fs::path> ControlGroups(std::string_view controller) {
  std::vector<fs::path> groups;
  std::ifstream table("/proc/self/cgroup");
  for (std::string line; std::getline(table, line);) {  // 4:memory,cpu:/a/b of version 1, 0::/a/b of version 2
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (first == line.npos || second == line.npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool is_v2 = line.starts_with("0::");
    if (!is_v2 && controllers.find("," + std::string(controller) + ",") == controllers.npos) continue;
    const fs::path root = is_v2 ? fs::path("/sys/fs/cgroup") : fs::path("/sys/fs/cgroup") / controller;
    for (fs::path path = line.substr(second + 1); path.has_relative_path(); path = path.parent_path())
      groups.push_back(root / path.relative_path());
    groups.push_back(root);
  }
  return groups;
}

std::optional<std::uint64_t> NumberInGroup(const fs::path& file) {
  std::ifstream text(file);
  std::int64_t number = 0;
  return text >> number && number > 0 ? std::optional(static_cast<std::uint64_t>(number)) : std::nullopt;
}

std::optional<GroupMemory> MemoryOfGroup(const fs::path& group) {
  constexpr std::uint64_t kNoLimit = std::uint64_t{1} << 60;  // version 1 has a larger number where version 2 has "max"
  GroupMemory memory;
  for (const char* name : {"memory.max", "memory.limit_in_bytes"})
    if (const auto limit = NumberInGroup(group / name); limit && *limit < kNoLimit)
      memory = {.file = group / name, .limit = *limit, .used = 0};
  if (memory.file.empty()) return std::nullopt;
  std::ifstream table(group / "memory.stat");
  std::uint64_t bytes = 0;
  for (std::string name; table >> name >> bytes;)  // of version 1 with all that is inside, as the others are
    if (name == "anon" || name == "shmem" || name == "total_rss" || name == "total_shmem") {
      const bool counts_twice = name == "shmem" && memory.file.filename() != "memory.max";
      if (!counts_twice) memory.used += bytes;
    }
  return memory;
}

std::optional<double> ProcessorsOfGroup(const fs::path& group) {
  std::ifstream both(group / "cpu.max"), quota(group / "cpu.cfs_quota_us"), period(group / "cpu.cfs_period_us");
  double used = 0, of = 0;  // microseconds; "max" and -1 say that there is no limit
  if ((both >> used >> of || (quota >> used && period >> of)) && used > 0 && of > 0) return used / of;
  return std::nullopt;
}

int UsableProcessors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  int processors = ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
  for (const fs::path& group : ControlGroups("cpu"))
    if (const auto limit = ProcessorsOfGroup(group); limit && *limit < processors)
      processors = static_cast<int>(*limit);
  return std::max(1, processors);
}

}  // namespace mascot
