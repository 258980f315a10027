#include "physics_server/process/agents_bundle.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "experiment/processes.h"

namespace mascot {
namespace {

/// Ids of the agents that are heard in a process, in the order of its sources.
std::vector<int> HeardIn(const Experiment& experiment, AgentRange agents, const std::vector<int>& sources) {
  std::set<int> heard;
  for (int id = agents.first; id <= agents.last; ++id)
    for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id)) heard.insert(neighbour.id);
  std::vector<int> in_order;
  std::ranges::copy_if(sources, std::back_inserter(in_order), [&](int id) { return heard.contains(id); });
  return in_order;
}

}  // namespace

AgentsBundle::AgentsBundle(const Experiment& experiment, AgentRange agents)
    : agents_(agents), sources_(SourcesOf(experiment, agents)), heard_(HeardIn(experiment, agents, sources_)) {}

}  // namespace mascot
