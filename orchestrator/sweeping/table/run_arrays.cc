#include "orchestrator/sweeping/table/run_arrays.h"

#include "experiment/experiment.h"

namespace mascot {

RunArrays::RunArrays(const Experiment& experiment) : experiment_(experiment), row_(experiment.size()) {
  for (const AgentConfig& agent : experiment.agents) ids_.push_back(agent.id);
}

void RunArrays::Add(const FlownRow& row) {
  row_.Set(experiment_.time_s(row.tick()), row.decoded());
  for (std::size_t a = 0; a < values_.size(); ++a)
    values_[a].insert(values_[a].end(), row_.Values(a).begin(), row_.Values(a).end());
}

std::vector<RunArray> RunArrays::All() const {
  std::vector<RunArray> arrays{{"id", {ids_.size()}, ids_, /*of_integers=*/true}};
  for (std::size_t a = 0; a < kStateArrays.size(); ++a) {
    const StateArray& array = kStateArrays[a];
    std::vector<std::size_t> shape{values_[a].size() / array.row_values(ids_.size())};
    if (!array.components.empty()) shape.push_back(ids_.size());
    if (array.components.size() > 1) shape.push_back(array.components.size());
    arrays.push_back({std::string(array.name), shape, values_[a]});
  }
  return arrays;
}

}  // namespace mascot
