#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/agent_range.h"
#include "experiment/experiment.h"
#include "idl/topics.h"

namespace mascot {

// What the graph lets the processes of a run read and write on DDS. The audit holds against it what discovery reports,
// and the certificates of network.security = "graph" allow nothing else.

/// Whether the process of `agents` may have a reader (`reads`) or a writer on `topic`.
bool MayHave(const Experiment& experiment, AgentRange agents, const Topic& topic, bool reads);
/// Whether the process of an agent's vehicle may read `topic`: what the agent commands, and what is for all.
bool VehicleReads(const Experiment& experiment, int agent, const Topic& topic);
/// Whether a run of this experiment has such a topic.
bool IsOfTheRun(const Experiment& experiment, const Topic& topic);

/// Topics that a process may read, and that it may write, in increasing order.
struct Rights {
  std::vector<Topic> reads, writes;
};
/// The rights of a process of the run. `process`: kPhysicsServer, kOrchestrator, or the name of a process of agents
/// or of a vehicle.
Rights RightsOf(const Experiment& experiment, std::string_view process);

}  // namespace mascot
