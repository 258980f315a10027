#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/read_experiment.h"

namespace mascot {

/// A key that an event may set in this experiment.
struct LiveKey {
  std::string path;  ///< dotted: "law.p_gain"
  Key row;
};

/// The keys that events may set in `experiment`, in the order of the file.
std::vector<LiveKey> LiveKeysOf(const Experiment& experiment, const LawCatalog& laws);
/// All keys of [law] for this law.
std::vector<Key> KeysOfLaw(const LawCatalog& laws, const std::string& law);
/// The names of all laws in the experiment, the team's first.
std::vector<std::string> LawNamesIn(const Experiment& experiment);
/// A dotted key as its first part and the rest, which `path` must outlive.
std::pair<std::string_view, std::string_view> SplitKey(std::string_view path);
/// The row of the dotted key `path` in `rows`; null if there is none. Inside a table whose keys the user chooses, every
/// key has the row of that table.
const Key* FindRow(std::span<const Key> rows, std::string_view path);

}  // namespace mascot
