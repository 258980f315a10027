#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// The tables of [[key]], for a list that has a limit because each of its tables makes work. If there are more than
/// `most`, the mistake is noted, and the result is empty.
inline std::vector<Section> FewTables(Section& section, std::string_view key, std::size_t most) {
  std::vector<Section> tables = section.Children(key);
  if (tables.size() <= most) return tables;
  section.Fail(key, "expected at most " + std::to_string(most) + " tables, got " + std::to_string(tables.size()));
  return {};
}

}  // namespace mascot
