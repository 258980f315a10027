#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "orchestrator/sweeping/table/sweep_identity.h"

namespace mascot {

/// The tables that `word` of the command line names: those of all shares of the table with this path, whether or not
/// they have been merged before; or else the file `word` itself. Throws ConfigError if there is neither.
std::vector<std::filesystem::path> TablesNamed(const std::string& word);

/// Path of the table of all runs, from the names of the tables of its shares. Throws ConfigError if they are not named
/// as shares of one table.
std::filesystem::path MergedTable(const std::vector<std::filesystem::path>& tables);

/// The identity of the sweep that a table is of, from TABLE.plan. Throws ConfigError if there is no such file, or it is
/// none of a sweep.
SweepIdentity IdentityOf(const std::filesystem::path& table);

struct Merged {
  std::size_t runs = 0;
  std::vector<std::string> lines;  ///< what became of the runs, for the terminal
};

/// Merges the tables of all shares of a sweep to the table that the sweep would have written as a whole, at `out`, with
/// its statistics. Throws ConfigError, and leaves `out` as it is, if the tables are of different sweeps or builds, if a
/// run is in two of them or in none, or if `out` is one of them, or (without `force`) the table of another sweep.
Merged Merge(const std::vector<std::filesystem::path>& tables, const std::string& out, bool force);

}  // namespace mascot
