#include "orchestrator/engines/dds/delivery.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <string>

#include "bus/sample_layout.h"
#include "experiment/processes.h"
#include "idl/topics.h"

namespace mascot {
namespace {

// Agent processes on one host. The ports of one DDS domain suffice for 120 participants, which include the physics
// server, the orchestrator and the discovery server.
constexpr std::ptrdiff_t kMaxProcesses = 110;
constexpr int kOthers = 2;  // every process talks to the physics server and the orchestrator
constexpr std::size_t kTicksInFlight = 4, kBytesPerParticipant = std::size_t{32} * 1024;  // which bus/qos.cc reserves
constexpr std::size_t kMaxParticipants = 20000;

int Participants(std::size_t bytes) {
  return kOthers + static_cast<int>(std::min(bytes / kBytesPerParticipant + 1, kMaxParticipants - kOthers));
}

/// The most bytes that the messages of these agents take at a tick.
std::size_t MessagesOf(const Experiment& experiment, const std::vector<int>& ids) {
  const auto senders = std::ranges::count_if(ids, [&](int id) { return experiment.agent(id).sends_messages; });
  return MessageBody(kMaxNumbers) * static_cast<std::size_t>(senders);
}

/// What the recorder receives in a tick, with network.delivery = "topics": the clock, states, commands and messages.
std::size_t SamplesOfATick(const Experiment& experiment) {
  const auto senders = std::ranges::count_if(experiment.agents, &AgentConfig::sends_messages);
  return 1 + 2 * experiment.agents.size() + static_cast<std::size_t>(senders);
}

}  // namespace

int ParticipantsOfServer(const Experiment& experiment) {
  if (!experiment.network.is_bundled())
    return static_cast<int>(std::min(kOthers + SamplesOfATick(experiment), kMaxParticipants));
  std::size_t bytes = 0;
  for (const AgentRange& agents : AgentProcesses(experiment)) {
    const std::vector<int> sources = SourcesOf(experiment, agents);
    bytes += kStateBody * sources.size() + MessagesOf(experiment, sources);
  }
  std::vector<int> all;
  for (const AgentConfig& agent : experiment.agents) all.push_back(agent.id);
  const std::size_t row = (kStateBody + kCommandBody) * all.size() + MessagesOf(experiment, all);
  return Participants(kTicksInFlight * bytes + kRecorderWindow * row);
}

int ParticipantsOfAgents(const Experiment& experiment, AgentRange agents) {
  std::vector<int> own;
  std::size_t topics = kOthers;
  for (int id = agents.first; id <= agents.last; ++id) {
    own.push_back(id);
    topics += 2 + experiment.graph.HeardBy(id).size();
  }
  if (experiment.network.is_bundled())
    return Participants(kTicksInFlight * (kCommandBody * own.size() + MessagesOf(experiment, own)));
  return agents.size() == 1 ? kOthers : static_cast<int>(std::min<std::size_t>(topics, kMaxParticipants));
}

std::vector<std::string> ArgumentsOf(const Experiment& experiment, int domain, int participants) {
  return {"--domain",       std::to_string(domain),
          "--transport",    TransportOf(experiment),
          "--wait-s",       std::to_string(static_cast<int>(experiment.run.start_timeout_s) + 1),
          "--participants", std::to_string(participants)};
}

std::vector<std::string> ArgumentsOf(const Experiment& experiment, int domain, AgentRange agents) {
  std::vector<std::string> arguments{"--id", IdsText(agents)};
  std::ranges::move(ArgumentsOf(experiment, domain, ParticipantsOfAgents(experiment, agents)),
                    std::back_inserter(arguments));
  return arguments;
}

std::vector<std::string> DeliveryWarnings(const Experiment& experiment) {
  if (experiment.network.is_bundled()) return {};
  return {"network.delivery: \"topics\" is for tools that listen to them; \"auto\" is faster"};
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
