#pragma once

#include <string>
#include <string_view>

namespace mascot {

/// Writes the file at `path` completely or not at all: writes `path`.part, syncs it to disk and renames it. Throws
/// std::runtime_error with the file's name and the system's reason.
void WriteWhole(const std::string& path, std::string_view text);

}  // namespace mascot
