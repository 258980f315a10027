#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

// Which agents of an experiment take actions: `text`, of the file at `path`, with `overrides`. The law that actions
// drive keeps the axes and the safety filter of the law in whose place it stands.

/// `overrides`, and if no agent of the experiment takes actions, before them one by which all agents take actions that
/// have no law of their own.
std::vector<Override> WithDrivenTeam(const std::string& text, const std::string& path, std::vector<Override> overrides);

/// The agents that take actions, in increasing id. Throws ConfigError if one begins to do so later in the run.
std::vector<int> AgentsThatAct(const Experiment& experiment);

/// The override by which the agents `ids` (each once) take actions, which replaces
/// agents.override and has all that the file says there. Throws ConfigError for a mistake in the experiment, for
/// an agent that is not in the team, and if `overrides` change agents.override, too.
Override DrivenAgents(const std::string& text, const std::string& path, std::span<const Override> overrides,
                      std::span<const int> ids);

}  // namespace mascot
