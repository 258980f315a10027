#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "agent/controller.h"

namespace mascot {

using ControllerFactory = std::unique_ptr<Controller>(const Experiment& experiment, std::span<const int> ids);
ControllerFactory MakeQuadrotorController, MakeDoubleIntegratorController, MakeSingleIntegratorController,
    MakeUnicycleController;  // each in agent/controllers/<model>.cc

namespace {

struct ControllerEntry {
  std::string_view model;
  ControllerFactory* make;
};

constexpr ControllerEntry kControllers[] = {
    {"quadrotor", MakeQuadrotorController},
    {"double_integrator", MakeDoubleIntegratorController},
    {"single_integrator", MakeSingleIntegratorController},
    {"unicycle", MakeUnicycleController},
};

}  // namespace

std::unique_ptr<Controller> MakeController(const Experiment& experiment, std::span<const int> ids) {
  const std::string& model = experiment.agent(ids.front()).model;
  const ControllerEntry* entry = std::ranges::find(kControllers, model, &ControllerEntry::model);
  if (entry == std::end(kControllers)) throw std::invalid_argument("no controller for the model: " + model);
  return entry->make(experiment, ids);
}

}  // namespace mascot
