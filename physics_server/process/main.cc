#include <CLI/CLI.hpp>

#include "bus/foreign_settings.h"
#include "bus/process_main.h"
#include "bus/scheduling.h"
#include "experiment/read_experiment.h"
#include "physics_server/process/server.h"
#include "system/standard_streams.h"

namespace {

class ServerRole : public mascot::Role {
 public:
  ServerRole(mascot::Domain& domain, mascot::Lifecycle& lifecycle, const mascot_msgs::msg::Experiment& message)
      : lifecycle_(lifecycle),
        experiment_(mascot::ReadWithoutLaws(mascot::Section::FromText(message.toml(), message.name()), message.name())),
        server_(domain, lifecycle, experiment_) {}

  void Run() override {
    mascot::ApplyScheduling(experiment_, 0);  // after all threads have started
    server_.Run();
    lifecycle_.Set(mascot::Life::kDone);
    for (;;) lifecycle_.Wait(std::chrono::seconds(1));  // stay until the run ends us: readers may need the last samples
  }

 private:
  mascot::Lifecycle& lifecycle_;
  const mascot::Experiment experiment_;
  mascot::Server server_;
};

}  // namespace

int main(int argc, char** argv) {
  mascot::OpenStandardStreams();
  mascot::FitStandardStreams();
  mascot::ForgetForeignSettings();
  mascot::StopSignal stop;  // before anything that starts threads: they must inherit the mask
  CLI::App app("MASCOT physics server: publishes every agent's state, gathers every command, steps the world.");
  mascot::ProcessArgs args(mascot::ProcessArgs::Kind::kServer);
  return mascot::ProcessMain(app, argc, argv, args, stop, [](auto& domain, auto& lifecycle, const auto& message) {
    return std::make_unique<ServerRole>(domain, lifecycle, message);
  });
}
