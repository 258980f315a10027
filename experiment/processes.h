#pragma once

#include <string>
#include <vector>

#include "base/agent_range.h"
#include "experiment/experiment.h"

namespace mascot {

/// The processes of agents, in increasing id. Each has network.agents_per_process agents, or fewer next to agents of
/// other hosts, and next to those that are started by hand, which have a process each.
std::vector<AgentRange> AgentProcesses(const Experiment& experiment);
/// By id - 1, the number of processes that need the agent's states: processes with the agent itself, or with an agent
/// that may ever hear it. With `heard_only`, only processes with an agent that may hear it count.
std::vector<int> HearingProcesses(const Experiment& experiment, bool heard_only);

/// How the processes of a run exchange samples: network.transport, but "udp" in place of "auto" if the run outlives
/// agents, or has vehicles to bring down. In shared memory, a process that is killed while it sends may leave a queue
/// locked, or with a place in it that is taken and never filled, and whose queue that is hears nothing more.
std::string TransportOf(const Experiment& experiment);
/// Whether the server asks again for answers that do not come, so that bundles and answers need no other care: in
/// lockstep, if the run has started all processes of agents, on this host, where they share memory.
bool AsksAgain(const Experiment& experiment);

/// The agents whose states a process needs: its own, then the others that these may ever hear; both in increasing id.
std::vector<int> SourcesOf(const Experiment& experiment, AgentRange process);

/// The agents of a process as `agent --id` takes them: "3", "1-50".
std::string IdsText(AgentRange agents);

}  // namespace mascot
