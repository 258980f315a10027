#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace mascot {

// Limits of control groups, such as containers and jobs have (cgroups(7), versions 1 and 2).

/// The folders of the control groups that this process is in and in which `controller` ("pids", "memory", "cpu") may
/// set limits, innermost first. Some folders may not exist, because a container sees only a part of the tree.
std::vector<std::filesystem::path> ControlGroups(std::string_view controller);

/// The positive number that a file of a control group holds; nothing: the file holds no number, such as "max".
std::optional<std::uint64_t> NumberInGroup(const std::filesystem::path& file);

struct GroupMemory {
  std::filesystem::path file;  ///< the file that has the limit
  std::uint64_t limit = 0;     ///< bytes
  std::uint64_t used = 0;      ///< bytes in use that cannot be freed: all but the cache of files
};

/// The memory of the control group in this folder; nothing: the group has no limit.
std::optional<GroupMemory> MemoryOfGroup(const std::filesystem::path& group);

/// How many processors' time the control group in this folder may use; nothing: the group has no limit.
std::optional<double> ProcessorsOfGroup(const std::filesystem::path& group);

/// How many threads of this process can work at the same time: as many as it may use processors (sched_setaffinity(2)),
/// and as its control groups give it whole processors' time; at least 1.
int UsableProcessors();

}  // namespace mascot
