#include "base/utf8.h"

#include <algorithm>

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

struct CodeRange {
  unsigned first, last;
};
/// Characters that change what others look like, or where they stand, on a terminal: controls (C0, DEL, C1), line and
/// paragraph separators, and what reverses the direction of text ("Trojan Source", CVE-2021-42574).
constexpr CodeRange kUnfit[] = {{0x00, 0x1F},     {0x7F, 0x9F},     {0x061C, 0x061C},
                                {0x200E, 0x200F}, {0x2028, 0x202E}, {0x2066, 0x2069}};

/// The number of a character.
unsigned CodeOf(std::string_view character) {
  if (character.size() == 1) return ByteAt(character, 0);
  unsigned code = ByteAt(character, 0) & (0x7Fu >> character.size());
  for (std::size_t i = 1; i < character.size(); ++i) code = code << 6 | (ByteAt(character, i) & 0x3Fu);
  return code;
}

/// `code` is at most U+FFFF.
std::string EscapeOf(unsigned code) {
  if (code == '\n') return "\\n";
  if (code == '\r') return "\\r";
  if (code == '\t') return "\\t";
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string escape = "\\u";
  for (int shift = 12; shift >= 0; shift -= 4) escape += kDigits[code >> shift & 0xFu];
  return escape;
}

/// `kept`: controls that stay.
std::string Fit(std::string_view bytes, std::string_view kept) {
  std::string text;
  text.reserve(bytes.size());
  while (!bytes.empty()) {
    const Piece piece = First(bytes);
    const std::string_view character = piece.valid ? bytes.substr(0, piece.bytes) : kReplacement;
    const unsigned code = CodeOf(character);
    const bool is_kept = code < 0x80 && kept.find(static_cast<char>(code)) != std::string_view::npos;
    const bool is_unfit = !is_kept && std::ranges::any_of(kUnfit, [code](const CodeRange& range) {
      return code >= range.first && code <= range.last;
    });
    if (is_unfit)
      text += EscapeOf(code);
    else
      text += character;
    bytes.remove_prefix(piece.bytes);
  }
  return text;
}

}  // namespace

std::string Plain(std::string_view bytes) { return Fit(bytes, "\n\t"); }

std::string PlainLine(std::string_view bytes) { return Fit(bytes, ""); }

std::size_t UnfinishedUtf8(std::string_view text) {
  for (std::size_t bytes = 1; bytes < 4 && bytes <= text.size(); ++bytes) {
    const std::string_view tail = text.substr(text.size() - bytes);
    if ((ByteAt(tail, 0) & 0xC0) == 0x80) continue;  // in the midst of a character
    const Piece piece = First(tail);
    // What follows the end might still make a character of it if it fails there, and not before.
    return !piece.valid && piece.bytes == tail.size() && ByteAt(tail, 0) >= 0xC2 && ByteAt(tail, 0) <= 0xF4 ? bytes : 0;
  }
  return 0;
}

std::string Shortened(std::string_view text, std::size_t longest) {
  return text.size() <= longest ? std::string(text) : std::string(CutUtf8(text, longest)) + "...";
}

std::string_view CutUtf8(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return text;
  for (std::size_t end = longest; end + 4 > longest; --end)
    if ((ByteAt(text, end) & 0xC0) != 0x80) return text.substr(0, end);  // a character begins there
  return text.substr(0, longest);                                        // no UTF-8
}

}  // namespace mascot
