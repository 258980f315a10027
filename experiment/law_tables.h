#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "experiment/agents.h"
#include "experiment/experiment.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// Reads the keys of a law table that all laws share. `team`: for an agent's own law, the table that it inherits from,
/// if it does. `laws` null: the document is a resolved one, which has them all.
LawConfig ReadLaw(Section& section, std::optional<Section> team, int count, const LawCatalog* laws);
/// Reads an agent's own law table, if its override has one; what it leaves out is as in [law] (`team`), if that has the
/// same law and the agent is not one of `alone`.
void ReadOwnLaw(AgentOverride& override, const Section& team, const std::set<int>& alone, int count,
                const LawCatalog* laws, Experiment& experiment);
/// Reads the parameters of the team's law and of agents' own laws. All else of the experiment has been read.
void ReadLawParameters(const LawCatalog& laws, Section& team, std::vector<AgentOverride>& overrides,
                       Experiment& experiment);
/// Reads [[law.schedule]], the team's and those of agents, as events; after ReadLawParameters(). Agents that send
/// messages in some phase are marked. `laws` null: the document is a resolved one, and its tables are not read further.
/// `rate_hz` = 0: times are unknown because of a mistake.
std::vector<Event> ReadLawSchedules(const LawCatalog* laws, Section& team, std::vector<AgentOverride>& overrides,
                                    int rate_hz, std::int64_t last_tick, Experiment& experiment);

}  // namespace mascot
