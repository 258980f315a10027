#include "orchestrator/reference/markdown.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace mascot {

std::string Cell(std::string_view text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? std::string("\\|") : std::string(1, c);
  return cell;
}

std::string DefaultText(const Key& key) {
  if (key.required) return "*required*";
  if (!key.fallback.empty()) return "`" + std::string(key.fallback) + "`";
  return std::string(key.otherwise);
}

std::string TableOfKeys(std::span<const Key> rows) {
  const bool any_live = std::ranges::any_of(rows, &Key::live);
  std::string text = any_live ? "\n| key | value | default | live | meaning |\n|---|---|---|---|---|\n"
                              : "\n| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const Key& key : rows)
    text += fmt::format("| `{}` | {} | {} |{} {} |\n", key.name, Cell(ValueText(key)), Cell(DefaultText(key)),
                        !any_live  ? ""
                        : key.live ? " live |"
                                   : " |",
                        Cell(key.meaning));
  return text;
}

std::string Sentence(std::string_view words) {
  std::string sentence(words);
  if (!sentence.empty()) sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
  return sentence + ".";
}

}  // namespace mascot
