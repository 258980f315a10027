#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiment/toml/key.h"

namespace mascot {

// What the generated pages in docs/ are made of.

/// Escapes text for a cell of a Markdown table.
std::string Cell(std::string_view text);
/// The default of a key: its TOML value as code, words, or "*required*".
std::string DefaultText(const Key& key);
/// A table of keys. The column `live` is left out if no key is.
std::string TableOfKeys(std::span<const Key> rows);
/// `words` with a capital at the beginning and a full stop at the end.
std::string Sentence(std::string_view words);

}  // namespace mascot
