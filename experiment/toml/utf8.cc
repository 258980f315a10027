#include "experiment/toml/utf8.h"

namespace mascot {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

unsigned ByteAt(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

struct Piece {
  std::size_t bytes;
  bool valid;  ///< a character; else bytes that begin one and do not end it, or one that begins none
};

/// The piece in front of `text`, which is not empty (The Unicode Standard, table 3-7).
Piece First(std::string_view text) {
  const unsigned lead = ByteAt(text, 0);
  if (lead < 0x80) return {1, true};
  if (lead < 0xC2 || lead > 0xF4) return {1, false};
  const std::size_t size = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  // The second byte has limits of its own: no overlong forms, no surrogates, nothing beyond U+10FFFF.
  const unsigned low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const unsigned high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (ByteAt(text, 1) < low || ByteAt(text, 1) > high) return {1, false};
  for (std::size_t i = 2; i < size; ++i)
    if (ByteAt(text, i) < 0x80 || ByteAt(text, i) > 0xBF) return {i, false};
  return {size, true};
}

}  // namespace

std::string Utf8(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  while (!bytes.empty()) {
    const Piece piece = First(bytes);
    text += piece.valid ? bytes.substr(0, piece.bytes) : kReplacement;
    bytes.remove_prefix(piece.bytes);
  }
  return text;
}

std::string_view CutUtf8(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return text;
  for (std::size_t end = longest; end + 4 > longest; --end)
    if ((ByteAt(text, end) & 0xC0) != 0x80) return text.substr(0, end);  // a character begins there
  return text.substr(0, longest);                                        // no UTF-8
}

}  // namespace mascot
