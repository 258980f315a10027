#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiment/agents.h"
#include "experiment/experiment.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// Reads the keys of a law table that all laws share. `team` is, for an agent's own law, the table from which it
/// inherits, if it does. If `laws` is null, the document is a resolved one, which has all keys. Mistakes are noted in
/// `section`.
LawConfig ReadLaw(Section& section, std::optional<Section> team, int count, const LawCatalog* laws);
/// Reads an agent's own law table, if its override has one. Keys that the table leaves out are as in [law] (`team`), if
/// the law is the same.
void ReadOwnLaw(AgentOverride& override, const Section& team, int count, const LawCatalog* laws,
                Experiment& experiment);
/// Reads the parameters of the team's law and of agents' own laws. Everything else of the experiment must have been
/// read.
void ReadLawParameters(const LawCatalog& laws, Section& team, std::vector<AgentOverride>& overrides,
                       Experiment& experiment);
/// Reads [[law.schedule]], the team's and those of agents, as events; after ReadLawParameters(). Agents that send
/// messages or take actions in some phase get AgentConfig::sends_messages and takes_actions. If `laws` is null, the
/// document is a resolved one, and its tables are not read further. If `rate_hz` is 0, times are unknown because of a
/// mistake.
std::vector<Event> ReadLawSchedules(const LawCatalog* laws, Section& team, std::vector<AgentOverride>& overrides,
                                    int rate_hz, std::int64_t last_tick, Experiment& experiment);

}  // namespace mascot
