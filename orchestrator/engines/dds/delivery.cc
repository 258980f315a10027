#include "orchestrator/engines/dds/delivery.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "experiment/processes.h"

namespace mascot {
namespace {

// Neighbours per agent, on average, from which on bundled delivery is faster (bench/: 2 times as fast at 15).
constexpr double kDense = 10;
// Agent processes on one host. The ports of one DDS domain suffice for 120 participants, which include the physics
// server, the orchestrator and the discovery server.
constexpr std::ptrdiff_t kMaxProcesses = 110;

}  // namespace

std::vector<std::string> DeliveryWarnings(const Experiment& experiment) {
  const double heard = static_cast<double>(experiment.graph.edges()) / std::max(experiment.size(), 1);
  if (experiment.network.delivery == Delivery::kBundled || heard < kDense) return {};
  return {
      fmt::format("network.delivery: each agent hears {:.3g} others on average, one sample each; over DDS \"bundled\", "
                  "one sample with all of them, is faster",
                  heard)};
}

void RefuseTooManyProcesses(const Experiment& experiment) {
  std::map<std::string, std::ptrdiff_t> processes_on;
  for (const AgentRange& agents : AgentProcesses(experiment)) {
    const AgentConfig& agent = experiment.agent(agents.first);
    if (!agent.external) ++processes_on[agent.host];
  }
  for (const auto& [host, processes] : processes_on)
    if (processes > kMaxProcesses)
      throw ConfigError(
          {fmt::format("network.agents_per_process: expected at most {} processes of agents on {} host, such as "
                       "by {}, got {} processes",
                       kMaxProcesses, host.empty() ? "this" : "each",
                       (experiment.size() + kMaxProcesses - 1) / kMaxProcesses, processes)});
}

}  // namespace mascot
