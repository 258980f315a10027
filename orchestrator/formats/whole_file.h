#pragma once

#include <string>
#include <string_view>

namespace mascot {

/// Writes the file at `path` whole or not at all: under a temporary name, synced to the disk, then in place of what was
/// there. Throws std::runtime_error with the file's name and the system's reason.
void WriteWhole(const std::string& path, std::string_view text);

}  // namespace mascot
