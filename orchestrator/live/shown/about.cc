#include "orchestrator/live/shown/about.h"

#include <chrono>
#include <utility>

#include "bus/wire.h"
#include "idl/topics.h"

namespace mascot {
namespace {

constexpr const char* kServiceName = "/mascot/ask";
constexpr std::string_view kRequestSchema =
    R"({"type":"object","required":["ask"],"properties":{)"
    R"("ask":{"enum":["pause","resume","stop","step","pace","event","seek","start","land","kill"]},)"
    R"("count":{"type":"integer"},"value":{"type":"number"},)"
    R"("toml":{"type":"string"},"t_s":{"type":"number"},"agent":{"type":"integer"}}})";
constexpr std::string_view kAnswerSchema =
    R"({"type":"object","properties":{"granted":{"type":"boolean"},"words":{"type":"string"}}})";

Foxglove::Channel JsonChannel(const std::string& topic, const std::string& type) {
  return {topic, "json", {"mascot" + topic, "jsonschema", R"({"type":")" + type + R"("})"}};
}

/// A name of this run by which clients tell it from another on the same port.
std::string NewSession() { return std::to_string(std::chrono::system_clock::now().time_since_epoch().count()); }

/// The writers and readers of each topic: every agent is a node of its own, though several may share a process.
Foxglove::Connections ConnectionsOf(const Experiment& experiment) {
  Foxglove::Connections connections;
  const std::string server = "/physics_server", recorder = "/orchestrator";
  const auto add = [&](const Topic& topic, const std::string& writer, std::vector<std::string> readers) {
    connections.writers[topic.Name()] = {writer};
    readers.push_back(recorder);
    connections.readers[topic.Name()] = std::move(readers);
  };
  std::vector<std::vector<std::string>> hearers(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents)
    for (const Graph::Neighbour& heard : experiment.graph.HeardBy(agent.id))
      hearers[static_cast<std::size_t>(heard.id - 1)].push_back("/" + AgentName(agent.id));
  for (const AgentConfig& agent : experiment.agents) {
    const std::string name = "/" + AgentName(agent.id);
    std::vector<std::string>& others = hearers[static_cast<std::size_t>(agent.id - 1)];
    if (agent.takes_actions) add(Topic::Action(agent.id), recorder, {name});
    add(Topic::Command(agent.id), name, {server});
    if (agent.sends_messages) add(Topic::Message(agent.id), name, others);
    others.push_back(name);
    add(Topic::State(agent.id), server, others);
  }
  add(Topic::Clock(), server, {});
  std::vector<std::string> all;
  for (const AgentConfig& agent : experiment.agents) all.push_back("/" + AgentName(agent.id));
  add(Topic::Event(), server, all);
  connections.providers[kServiceName] = {recorder};
  return connections;
}

}  // namespace

Foxglove::About AboutTheRun(const Experiment& experiment, std::vector<Foxglove::Channel> ros, std::int64_t last_tick) {
  Foxglove::About about{.name = "mascot: " + experiment.run.name,
                        .session = NewSession(),
                        .end_ns = StampNs(last_tick, experiment.control.rate_hz),
                        .channels = {JsonChannel("/ui/experiment", "object"), JsonChannel("/ui/frame", "object"),
                                     JsonChannel("/ui/events", "array"), JsonChannel("/ui/curves", "object"),
                                     JsonChannel("/ui/metrics", "object"), JsonChannel("/ui/vehicles", "array")},
                        .connections = [&experiment] { return ConnectionsOf(experiment); },
                        .service = kServiceName,
                        .request = {"mascot/Wish", "jsonschema", std::string(kRequestSchema)},
                        .response = {"mascot/Answer", "jsonschema", std::string(kAnswerSchema)}};
  for (Foxglove::Channel& channel : ros) about.channels.push_back(std::move(channel));
  return about;
}

}  // namespace mascot
