#include "experiment/processes.h"

#include <algorithm>
#include <set>

namespace mascot {

std::vector<AgentRange> AgentProcesses(const Experiment& experiment) {
  std::vector<AgentRange> processes;
  bool may_join = false;
  for (const AgentConfig& agent : experiment.agents) {
    const bool fits = may_join && agent.host == experiment.agent(processes.back().last).host;
    if (fits && !agent.external && processes.back().size() < experiment.network.agents_per_process)
      processes.back().last = agent.id;
    else
      processes.push_back({agent.id, agent.id});
    may_join = !agent.external;
  }
  return processes;
}

std::vector<int> HearingProcesses(const Experiment& experiment, bool heard_only) {
  std::vector<int> count(experiment.agents.size(), 0);
  for (const AgentRange& process : AgentProcesses(experiment)) {
    std::set<int> heard;
    for (int id = process.first; id <= process.last; ++id) {
      if (!heard_only) heard.insert(id);
      for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id)) heard.insert(neighbour.id);
    }
    for (const int id : heard) ++count[static_cast<std::size_t>(id - 1)];
  }
  return count;
}

std::string TransportOf(const Experiment& experiment) {
  const bool outlives_processes =
      experiment.run.on_agent_loss != OnAgentLoss::kAbort || !AgentsWithVehicles(experiment).empty();
  return experiment.network.transport == "auto" && outlives_processes ? "udp" : experiment.network.transport;
}

bool AsksAgain(const Experiment& experiment) {
  return experiment.run.mode == Mode::kLockstep && experiment.network.is_bundled() &&
         TransportOf(experiment) != "udp" && std::ranges::none_of(experiment.agents, [](const AgentConfig& agent) {
           return agent.external || !agent.host.empty();
         });
}

std::vector<int> SourcesOf(const Experiment& experiment, AgentRange process) {
  std::set<int> others;
  std::vector<int> sources;
  for (int id = process.first; id <= process.last; ++id) {
    sources.push_back(id);
    for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id))
      if (!process.Holds(neighbour.id)) others.insert(neighbour.id);
  }
  sources.insert(sources.end(), others.begin(), others.end());
  return sources;
}

std::string IdsText(AgentRange agents) {
  return std::to_string(agents.first) + (agents.size() > 1 ? "-" + std::to_string(agents.last) : "");
}

}  // namespace mascot
