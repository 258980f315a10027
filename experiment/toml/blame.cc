#include "experiment/toml/blame.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "base/utf8.h"
#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

bool Contains(const std::vector<std::string>& mistakes, const std::string& mistake) {
  return std::ranges::find(mistakes, mistake) != mistakes.end();
}

/// A mistake in the document, as its place and what is wrong there.
struct Placed {
  std::string_view place;  ///< "a.toml:4:7"
  std::string_view text;
};

/// The parts of a mistake; nothing if it stands at no line of the document `name`.
std::optional<Placed> Split(std::string_view mistake, std::string_view name) {
  if (!mistake.starts_with(name)) return std::nullopt;
  std::size_t end = name.size();
  for (int number = 0; number < 2; ++number) {
    if (end >= mistake.size() || mistake[end++] != ':') return std::nullopt;
    const std::size_t begin = end;
    while (end < mistake.size() && std::isdigit(static_cast<unsigned char>(mistake[end])) != 0) ++end;
    if (end == begin) return std::nullopt;
  }
  if (!mistake.substr(end).starts_with(": ")) return std::nullopt;
  return Placed{mistake.substr(0, end), mistake.substr(end + 2)};
}

/// The override without which the document does not have the mistake: the last of several. If there is none, because
/// more than one makes it, the last of all. What takes keys out follows from others, and is no maker.
const Override& MakerOf(const std::string& mistake, std::span<const Override> overrides,
                        const MistakesWith& mistakes_with) {
  for (std::size_t left = overrides.size(); overrides.size() > 1 && left > 0; --left) {
    const std::size_t k = left - 1;
    if (overrides[k].removes) continue;
    std::vector<Override> others(overrides.begin(), overrides.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (!Contains(mistakes_with(others), mistake)) return overrides[k];
  }
  const auto last = std::find_if(overrides.rbegin(), overrides.rend(), [](const Override& o) { return !o.removes; });
  return last == overrides.rend() ? overrides.back() : *last;
}

}  // namespace

std::vector<std::string> BlameOverrides(const std::vector<std::string>& mistakes, const std::string& name,
                                        std::span<const Override> overrides, const MistakesWith& mistakes_with) {
  if (overrides.empty()) return mistakes;
  const std::string shown = PlainLine(name);
  if (std::ranges::none_of(mistakes, [&](const std::string& mistake) { return Split(mistake, shown).has_value(); }))
    return mistakes;
  const std::vector<std::string> before = mistakes_with({});
  std::vector<std::string> of_document, of_overrides;
  for (const std::string& mistake : mistakes) {
    const std::optional<Placed> placed = Split(mistake, shown);
    if (!placed) {
      of_overrides.push_back(mistake);
    } else if (Contains(before, mistake)) {
      of_document.push_back(mistake);
    } else {
      std::string text = OriginOf(MakerOf(mistake, overrides, mistakes_with)) + ": ";
      text.append(placed->text);
      if (!placed->place.ends_with(":1:1")) text.append(" (").append(placed->place).append(")");
      of_overrides.push_back(std::move(text));
    }
  }
  of_document.insert(of_document.end(), of_overrides.begin(), of_overrides.end());
  return of_document;
}

}  // namespace mascot
