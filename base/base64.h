#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace mascot {

/// `bytes` in base64 (RFC 4648), with padding, without line breaks.
std::string ToBase64(std::string_view bytes);
/// The bytes of a text in base64; nothing if it is none. Of each text there is one for the same bytes: bits that do
/// not count must be 0.
std::optional<std::string> FromBase64(std::string_view text);

}  // namespace mascot
