#include <algorithm>
#include <stdexcept>

#include "physics_server/model.h"

namespace mascot {

using ModelFactory = std::unique_ptr<Model>(const Experiment& experiment, int id);
// Each in physics_server/models/<name>.cc.
ModelFactory MakeQuadrotor, MakeDoubleIntegrator, MakeSingleIntegrator, MakeUnicycle;

namespace {

constexpr ModelEntry kModels[] = {
    {"quadrotor", "rigid body with four rotors, linear drag and the airframe's limits", "speeds of rotors 1..4 (rad/s)",
     MakeQuadrotor},
    {"double_integrator", "point of 1 kg without gravity: p'' = u", "force x, y, z in W (N), unused",
     MakeDoubleIntegrator},
    {"single_integrator", "point with the velocity it is told: p' = u", "velocity x, y, z in W (m/s), unused",
     MakeSingleIntegrator},
    {"unicycle", "rolls forward and turns in a horizontal plane: x' = v cos a, y' = v sin a, a' = w",
     "forward speed (m/s), turning speed (rad/s), unused, unused", MakeUnicycle},
};

}  // namespace

std::span<const ModelEntry> Models() { return kModels; }

std::unique_ptr<Model> MakeModel(const Experiment& experiment, int id) {
  const std::string& name = experiment.agent(id).model;
  const ModelEntry* entry = std::ranges::find(kModels, name, &ModelEntry::name);
  if (entry == std::end(kModels)) throw std::invalid_argument("no such model: " + name);
  return entry->make(experiment, id);
}

}  // namespace mascot
