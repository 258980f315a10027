#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "orchestrator/sweeping/table/sweep_identity.h"

namespace mascot {

/// The tables that a word of the command line names: those of all shares of the table of that name, whether or not they
/// have been merged before, or else that file. Throws ConfigError if there is neither.
std::vector<std::filesystem::path> TablesNamed(const std::string& word);

/// The table of all runs that `tables`, of shares of one sweep, are part of. Throws ConfigError if they do not tell, by
/// their names.
std::filesystem::path MergedTable(const std::vector<std::filesystem::path>& tables);

/// What a table is of. Throws ConfigError if it does not tell, in its .plan.
SweepIdentity IdentityOf(const std::filesystem::path& table);

struct Merged {
  std::size_t runs = 0;
  std::vector<std::string> lines;  ///< what became of the runs, for the terminal
};

/// Makes of the tables of all shares of a sweep the one that the sweep would have made by itself, with its statistics,
/// at `out`. Throws ConfigError, and leaves `out` as it is, if the tables are of different sweeps or builds, if a run
/// is in two of them or in none, or if `out` is one of them, or another table (without `force`).
Merged Merge(const std::vector<std::filesystem::path>& tables, const std::string& out, bool force);

}  // namespace mascot
