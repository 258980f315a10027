#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "agent/controller.h"

namespace mascot {

using ControllerFactory = std::unique_ptr<Controller>(const Experiment& experiment, int id);
ControllerFactory MakeQuadrotorController, MakeDoubleIntegratorController, MakeSingleIntegratorController,
    MakeUnicycleController;  // each in agent/controllers/<model>.cc

namespace {

struct ControllerEntry {
  std::string_view model;
  Wanted driven_by;
  bool turns_to_heading;
  ControllerFactory* make;
};

constexpr ControllerEntry kControllers[] = {
    {"quadrotor", Wanted::kAcceleration, true, MakeQuadrotorController},
    {"double_integrator", Wanted::kAcceleration, false, MakeDoubleIntegratorController},
    {"single_integrator", Wanted::kVelocity, false, MakeSingleIntegratorController},
    {"unicycle", Wanted::kVelocity, false, MakeUnicycleController},
};

const ControllerEntry& Entry(const std::string& model) {
  const ControllerEntry* entry = std::ranges::find(kControllers, model, &ControllerEntry::model);
  if (entry == std::end(kControllers)) throw std::invalid_argument("no controller for the model: " + model);
  return *entry;
}

}  // namespace

Wanted DrivenBy(const std::string& model) { return Entry(model).driven_by; }

bool TurnsToHeading(const std::string& model) { return Entry(model).turns_to_heading; }

std::unique_ptr<Controller> MakeController(const Experiment& experiment, int id) {
  return Entry(experiment.agent(id).model).make(experiment, id);
}

}  // namespace mascot
