#pragma once

#include <sys/types.h>

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mascot {

/// Which file it is, whatever its name: the numbers of its device and of its inode.
using FileId = std::pair<dev_t, ino_t>;

/// The file at `path`; zeros: there is none.
FileId IdOf(const std::string& path);

/// The files with paths that begin with `prefix` and that other processes have open or map, of those processes that the
/// caller may look at. A process that keeps a file open until it has mapped it is never missed: what processes have
/// open is looked at before what they map.
std::set<FileId> FilesInUse(const std::string& prefix);

/// The paths in a folder. Those found so far, if the folder vanishes meanwhile, as those of /proc do.
std::vector<std::filesystem::path> PathsIn(const std::filesystem::path& folder);

}  // namespace mascot
