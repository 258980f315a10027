#include <CLI/CLI.hpp>
#include <iostream>

#include "agent/laws.h"
#include "agent/node.h"
#include "idl/process_main.h"
#include "idl/standard_streams.h"

namespace {

void RunAgent(mascot::Domain& domain, mascot::Lifecycle& lifecycle, const mascot_msgs::msg::Experiment& message,
              int id) {
  const auto document = mascot::Section::FromText(message.toml(), message.name());
  mascot::Experiment experiment = mascot::LoadExperiment(document, message.name(), /*checked=*/true);
  if (id > experiment.size())
    throw std::runtime_error("--id " + std::to_string(id) + ": the experiment has only agents 1 to " +
                             std::to_string(experiment.size()));
  std::string heard;
  for (const auto& neighbour : experiment.graph.HeardBy(id)) heard += " " + std::to_string(neighbour.id);
  std::cerr << "hears" << (heard.empty() ? " nobody" : heard) << std::endl;
  mascot::Node(domain, lifecycle, experiment, id).Run();
}

}  // namespace

int main(int argc, char** argv) {
  mascot::OpenStandardStreams();
  mascot::StopSignal stop;  // before all else: threads that libraries start must inherit the blocked mask
  CLI::App app("MASCOT agent: hears its neighbours, runs its law and its low-level stack, commands its actuators.");
  mascot::ProcessArgs args(/*agent_process=*/true);
  return mascot::ProcessMain(app, argc, argv, args, stop, [&args](auto& domain, auto& lifecycle, const auto& message) {
    RunAgent(domain, lifecycle, message, args.agent);
  });
}
