#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "experiment/live_tables.h"
#include "experiment/read_experiment.h"

namespace mascot {

/// The laws of an experiment whose law tables have been read again.
struct LawsAgain {
  std::optional<LawConfig> team;  ///< absent: as before
  std::map<int, LawConfig> own;   ///< of agents with a law table of their own, by id; absent: as before
  std::set<int> owners;           ///< the agents that have one

  /// The law that an agent has now.
  const LawConfig& Of(const AgentConfig& agent) const;
  /// Nothing changes of the tick at which each began.
  void Apply(Experiment& next) const;
};

/// Reads again the law tables of `touched`, or all of them (`all`), each by the reader of its own law; agents' own
/// tables inherit from [law] as in the file. `laws` null: without parameters. `alone`: ids of the agents whose own
/// tables inherit nothing. Mistakes are noted in `tables`.
LawsAgain ReadLawsAgain(const TouchedTables& touched, bool all, Section& tables, const std::vector<int>& owners,
                        const std::set<int>& alone, const LawCatalog* laws, const Experiment& now);

}  // namespace mascot
