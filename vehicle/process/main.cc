#include <CLI/CLI.hpp>

#include "bus/foreign_settings.h"
#include "bus/process_main.h"
#include "experiment/read_experiment.h"
#include "system/standard_streams.h"
#include "vehicle/process/vehicle_node.h"

namespace {

/// Reads the experiment. Throws std::runtime_error if the agent has no vehicle in it.
mascot::Experiment ReadFor(int agent, const mascot_msgs::msg::Experiment& message) {
  mascot::Experiment experiment =
      mascot::ReadWithoutLaws(mascot::Section::FromText(message.toml(), message.name()), message.name());
  if (agent > experiment.size() || !experiment.agent(agent).vehicle)
    throw std::runtime_error("--id " + std::to_string(agent) + ": the agent has no vehicle in this experiment");
  return experiment;
}

class VehicleRole : public mascot::Role {
 public:
  VehicleRole(mascot::Domain& domain, mascot::Lifecycle& lifecycle, const mascot_msgs::msg::Experiment& message,
              const mascot::ProcessArgs& args)
      : experiment_(ReadFor(args.agents.first, message)),
        node_(domain, lifecycle, experiment_, args.agents.first,
              {.domain = experiment_.agent(args.agents.first).vehicle->domain,
               .name = args.options.name,
               .address = experiment_.agent(args.agents.first).vehicle->address}) {}

  void Run() override { node_.Run(); }

 private:
  const mascot::Experiment experiment_;
  mascot::VehicleNode node_;
};

}  // namespace

int main(int argc, char** argv) {
  mascot::OpenStandardStreams();
  mascot::FitStandardStreams();
  mascot::ForgetForeignSettings();
  mascot::StopSignal stop;  // before anything that starts threads: they must inherit the mask
  CLI::App app("MASCOT vehicle: flies the vehicle of one agent by its autopilot, as the agent commands.");
  mascot::ProcessArgs args(mascot::ProcessArgs::Kind::kVehicle);
  return mascot::ProcessMain(app, argc, argv, args, stop, [&args](auto& domain, auto& lifecycle, const auto& message) {
    return std::make_unique<VehicleRole>(domain, lifecycle, message, args);
  });
}
