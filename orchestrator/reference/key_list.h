#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/key.h"

namespace mascot {

/// A key that an experiment file may have, with its whole name.
struct ListedKey {
  std::string name;  ///< dotted, as `--set` takes it: "agents.random.shape"
  Key row;
  std::vector<std::string_view> laws;  ///< the laws whose key of [law] this is; empty: it is no parameter of a law
};

/// All keys, from the tables that the reader uses, in their order; then the parameters of the laws, each with the laws
/// that have it in these words. Tables themselves are left out, but for those whose keys the user chooses.
std::vector<ListedKey> AllKeys();

/// Text of a first experiment with this law: `example`, an experiment that shows it, with the law's other keys as
/// comments behind those that it has. Throws std::runtime_error if the example has no table [law].
std::string NewExperiment(std::string_view law, const std::string& example);

}  // namespace mascot
