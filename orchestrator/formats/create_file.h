#pragma once

#include <string>

namespace mascot {

/// Makes the file `path` anew and opens it, with `access` O_WRONLY or O_RDWR. A regular file of that name is removed
/// first. Anything else with the name stays as it is, and no link is followed: then throws std::runtime_error, "cannot
/// create PATH: a symbolic link has this name".
int CreateFile(const std::string& path, int access);

/// Removes the regular file `path`, if there is one. Throws std::runtime_error, as CreateFile, if anything else has the
/// name.
void RemoveFile(const std::string& path);

/// Throws std::runtime_error if something has the name `path` that a finished file may not replace: anything but a
/// regular file or a link.
void RequireReplaceable(const std::string& path);

}  // namespace mascot
