#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/events.h"
#include "experiment/experiment.h"
#include "experiment/toml/section.h"
#include "experiment/toml/value_tables.h"

namespace mascot {

/// What new values make of an experiment, once all of them have been read: nothing fails any more.
using Change = std::function<void(Experiment&)>;

/// The tables of a resolved experiment that have live keys, and of them what their readers below need: an experiment's
/// values as events change them. An agent's own tables are in agents.override.
ValueTables LiveTablesOf(const std::string& resolved);

/// Whether two events change values in the same table. If not, neither is ever wrong because of the other: no reader of
/// what is live in a table asks another table for what is live in that. One that cuts or mends edges changes none.
bool ShareATable(const Event& a, const Event& b);

/// Tables in which an event has changed a value.
struct TouchedTables {
  std::set<std::string, std::less<>> of_all;  ///< by name: "link"
  /// Agents' own, by name: their indices in agents.override, in order.
  std::map<std::string, std::set<std::size_t>, std::less<>> own;

  bool HasAny(std::string_view table) const { return of_all.contains(table) || own.contains(table); }
};

/// Reads again those of `touched` that are no law, each by the reader that reads it in the file: run, physics, control,
/// graph and link. `owners`: the id of the agent of each agents.override, by its index. Mistakes are noted in `tables`.
std::vector<Change> ReadAgain(const TouchedTables& touched, Section& tables, const std::vector<int>& owners,
                              const Experiment& now);

}  // namespace mascot
