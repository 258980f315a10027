#include <algorithm>
#include <stdexcept>

#include "physics_server/model.h"

namespace mascot {

using ModelFactory = std::unique_ptr<Model>(const Experiment& experiment, int id);
// Defined in physics_server/models/<name>.cc.
ModelFactory MakeQuadrotor, MakeDoubleIntegrator, MakeSingleIntegrator, MakeUnicycle, MakeMovedBody;

namespace {

struct ModelEntry {
  std::string_view model;
  ModelFactory* make;
};

constexpr ModelEntry kModels[] = {
    {"quadrotor", MakeQuadrotor},
    {"double_integrator", MakeDoubleIntegrator},
    {"single_integrator", MakeSingleIntegrator},
    {"unicycle", MakeUnicycle},
};

}  // namespace

std::unique_ptr<Model> MakeModel(const Experiment& experiment, int id) {
  if (experiment.agent(id).vehicle) return MakeMovedBody(experiment, id);
  const std::string& name = experiment.agent(id).model;
  const ModelEntry* entry = std::ranges::find(kModels, name, &ModelEntry::model);
  if (entry == std::end(kModels)) throw std::invalid_argument("no such model: " + name);
  return entry->make(experiment, id);
}

}  // namespace mascot
