#pragma once

#include <vector>

#include "experiment/agent_range.h"
#include "experiment/experiment.h"

namespace mascot {

/// Which agents share a process, in increasing id: network.agents_per_process of them, fewer beside those that are
/// started by hand, each of whom has a process of its own.
std::vector<AgentRange> AgentProcesses(const Experiment& experiment);
/// How many processes have an agent for whom the states of agent `id` are: itself, and those that may ever hear it.
/// By id - 1. `heard_only`: without the agent's own.
std::vector<int> HearingProcesses(const Experiment& experiment, bool heard_only);

}  // namespace mascot
