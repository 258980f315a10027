#include <CLI/CLI.hpp>

#include "bus/privileges.h"
#include "bus/process_main.h"
#include "bus/standard_streams.h"
#include "experiment/read_experiment.h"
#include "physics_server/server.h"

namespace {

void RunServer(mascot::Domain& domain, mascot::Lifecycle& lifecycle, const mascot_msgs::msg::Experiment& message) {
  const auto document = mascot::Section::FromText(message.toml(), message.name());
  const mascot::Experiment experiment = mascot::ReadWithoutLaws(document, message.name());
  mascot::Server server(domain, lifecycle, experiment);
  mascot::TakePrivileges(experiment, 0);  // after all threads have started
  server.Run();
  lifecycle.Set(mascot::Life::kDone);
  for (;;) lifecycle.Wait(std::chrono::seconds(1));  // stay until the run ends us: readers may need the last samples
}

}  // namespace

int main(int argc, char** argv) {
  mascot::OpenStandardStreams();
  mascot::StopSignal stop;  // before anything that starts threads: they must inherit the mask
  CLI::App app("MASCOT physics server: publishes every agent's state, gathers every command, steps the world.");
  mascot::ProcessArgs args(/*agent_process=*/false);
  return mascot::ProcessMain(app, argc, argv, args, stop, RunServer);
}
