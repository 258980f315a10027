#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mascot {

/// `bytes` as valid UTF-8: whatever is none becomes U+FFFD, one for each broken character. Everything that comes from
/// outside and may end up in a summary, a table or a status passes through here: what children print, what other
/// processes say of themselves, what the laws of others throw.
std::string Utf8(std::string_view bytes);

/// The first characters of `text` that fit into `longest` bytes (at least 4).
std::string_view CutUtf8(std::string_view text, std::size_t longest);

}  // namespace mascot
