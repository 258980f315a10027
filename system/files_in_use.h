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

/// The files with paths that begin with `prefix` and that other processes have open or mapped. Processes that the
/// caller may not look at are left out. A file that a process keeps open until it has mapped it is never missed,
/// because open files are looked at before mapped ones.
std::set<FileId> FilesInUse(const std::string& prefix);

/// The paths in a folder; if the folder vanishes meanwhile, as folders of /proc do, those that were found so far.
std::vector<std::filesystem::path> PathsIn(const std::filesystem::path& folder);

}  // namespace mascot
