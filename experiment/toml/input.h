#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace mascot {

/// The open descriptor of this process that a path names: 0 for "-" and /dev/stdin, N for /dev/fd/N and
/// /proc/self/fd/N, which a shell makes of <(COMMAND). Nothing for all other paths.
std::optional<int> DescriptorOf(const std::string& path);

/// What messages call the file at `path`: "<stdin>", or the path itself.
std::string NameOfInput(const std::string& path);

/// The file's name without folder and ending, which is the name of what the file describes; "" for a descriptor, which
/// has no name. `name` is that of NameOfInput().
std::string StemOfInput(const std::string& name);

/// The largest file that is read as text (bytes): ten thousand agents with their edges need about 1 MiB.
inline constexpr std::size_t kLargestFile = std::size_t{16} << 20;

/// The text at `path`: that of a regular file, or all that comes out of an open descriptor, which can be read only
/// once. At most 16 MiB. Throws ConfigError, e.g. "PATH: is a directory".
std::string ReadInput(const std::string& path);

}  // namespace mascot
