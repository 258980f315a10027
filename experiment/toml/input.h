#pragma once

#include <optional>
#include <string>

namespace mascot {

/// The open descriptor of this process that a path names: 0 of "-" and /dev/stdin, N of /dev/fd/N and /proc/self/fd/N,
/// which is what a shell puts for <(COMMAND). Nothing for all other paths.
std::optional<int> DescriptorOf(const std::string& path);

/// What messages call the file at `path`: "<stdin>", or the path itself.
std::string NameOfInput(const std::string& path);

/// The file's name without folder and ending, as the name of what it describes; "" of a descriptor, which has none.
/// `name`: as NameOfInput() says it.
std::string StemOfInput(const std::string& name);

/// The text at `path`: that of a regular file, or all that comes out of an open descriptor, which can be read only
/// once. At most 16 MiB. Throws ConfigError, e.g. "PATH: is a directory".
std::string ReadInput(const std::string& path);

}  // namespace mascot
