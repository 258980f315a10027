#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>

#include "base/utf8.h"
#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

std::string Shortest(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string Escaped(char c) {
  switch (c) {
    case '"':
      return "\\\"";
    case '\\':
      return "\\\\";
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
  }
  return fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
}

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }
char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Edit distance in which a swap of neighbouring letters counts as one edit (Damerau, CACM 7(3), 1964).
std::size_t Distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = Lower(a[i - 1]) == Lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && Lower(a[i - 1]) == Lower(b[j - 2]) && Lower(a[i - 2]) == Lower(b[j - 1]))
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = std::exchange(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string ShortestFloat(double value) {
  std::string text = Shortest(value);
  if (std::isfinite(value) && text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string Range::Text() const { return (open_min ? "(" : "[") + Shortest(min) + ", " + Shortest(max) + "]"; }

std::string QuotedToml(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += IsControl(c) || c == '"' || c == '\\' ? Escaped(c) : std::string(1, c);
  return quoted + "\"";
}

std::string StringToml(std::string_view text) {
  const bool is_plain =
      std::none_of(text.begin(), text.end(), [](char c) { return IsControl(c) && c != '\n' && c != '\t'; });
  const bool fits = text.find('\n') != text.npos && text.find("'''") == text.npos && !text.ends_with('\'');
  return is_plain && fits ? "'''\n" + std::string(text) + "'''" : QuotedToml(text);
}

bool HasControls(std::string_view text) { return std::any_of(text.begin(), text.end(), IsControl); }

std::string CutShort(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  if (text.size() <= kLongest) return std::string(text);
  return std::string(CutUtf8(text, kLongest)) + "...";
}

std::string Printable(std::string_view text) { return PlainLine(CutShort(text)); }

std::string EachOnce(std::string_view kind, const std::string& thing, std::string_view once) {
  return fmt::format("expected each {} {}, got {} again", kind, once, thing);
}

std::optional<std::string> DidYouMean(std::string_view word, std::span<const std::string_view> names) {
  constexpr std::size_t kLongest = 64;  // nobody mistypes more; keeps the distance cheap on junk
  if (word.size() > kLongest) return std::nullopt;
  std::optional<std::string> nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view name : names) {
    const bool lacks_unit = name.size() > word.size() && name[word.size()] == '_' && name.starts_with(word);
    const std::size_t distance = lacks_unit ? 1 : Distance(word, name);
    if (distance >= least || distance >= name.size()) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

}  // namespace mascot
