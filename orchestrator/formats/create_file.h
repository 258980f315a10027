#pragma once

#include <string>

namespace mascot {

/// Makes the file `path` anew and opens it, with `access` O_WRONLY or O_RDWR. A regular file of that name is taken away
/// first. Whatever else has the name is left as it is, and no link is followed: throws std::runtime_error, "cannot
/// create PATH: a symbolic link has this name".
int CreateFile(const std::string& path, int access);

/// Throws likewise if something has the name `path` that a finished file may not take the place of: anything but a
/// regular file or a link, which are replaced.
void RequireReplaceable(const std::string& path);

}  // namespace mascot
