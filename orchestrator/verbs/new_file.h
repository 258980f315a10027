#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace mascot {

/// Path of a file that a verb makes of a recording: `name` beside the recording, or the file or folder that --out
/// gives. Throws ConfigError if no file can be made there, if it is the recording itself, or if it exists and `force`
/// (--force) is not given.
std::filesystem::path NewFile(const std::optional<std::string>& out, const std::string& name,
                              const std::string& recording, bool force);

}  // namespace mascot
