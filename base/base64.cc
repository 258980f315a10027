#include "base/base64.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace mascot {
namespace {

constexpr std::string_view kBase64Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNone = 64;

constexpr std::array<std::uint8_t, 256> kValues = [] {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNone);
  for (std::size_t k = 0; k < kBase64Digits.size(); ++k)
    values[static_cast<unsigned char>(kBase64Digits[k])] = static_cast<std::uint8_t>(k);
  return values;
}();

std::uint32_t ByteOf(char c) { return static_cast<unsigned char>(c); }

}  // namespace

std::string ToBase64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t count = bytes.size() - k < 3 ? bytes.size() - k : 3;
    std::uint32_t bits = ByteOf(bytes[k]) << 16;
    if (count > 1) bits |= ByteOf(bytes[k + 1]) << 8;
    if (count > 2) bits |= ByteOf(bytes[k + 2]);
    for (std::size_t digit = 0; digit < 4; ++digit)
      text += digit <= count ? kBase64Digits[(bits >> (18 - 6 * digit)) & 63] : '=';
  }
  return text;
}

std::optional<std::string> FromBase64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
  const std::size_t digits = text.size() - padding;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  unsigned held = 0;  // how many bits are not yet in `bytes`
  for (const char c : text.substr(0, digits)) {
    const std::uint32_t value = kValues[ByteOf(c)];
    if (value == kNone) return std::nullopt;
    bits = ((bits << 6) | value) & 0xFFFF;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>((bits >> held) & 0xFF);
  }
  if ((bits & ((1U << held) - 1)) != 0) return std::nullopt;
  return bytes;
}

}  // namespace mascot
