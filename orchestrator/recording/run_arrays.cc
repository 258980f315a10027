#include "orchestrator/recording/run_arrays.h"

#include "experiment/experiment.h"

namespace mascot {

RunArrays::RunArrays(int agents, int rate_hz) : rate_hz_(rate_hz), row_(agents) {
  for (int id = 1; id <= agents; ++id) ids_.push_back(id);
}

RunArrays::RunArrays(const Experiment& experiment) : RunArrays(experiment.size(), experiment.control.rate_hz) {}

void RunArrays::Add(std::int64_t tick, const DecodedRow& row) {
  row_.Set(static_cast<double>(tick) / rate_hz_, row);
  for (std::size_t a = 0; a < values_.size(); ++a)
    values_[a].insert(values_[a].end(), row_.Values(a).begin(), row_.Values(a).end());
}

std::vector<RunArray> RunArrays::First(std::size_t rows) const {
  std::vector<RunArray> arrays{{"id", {ids_.size()}, ids_, /*of_integers=*/true}};
  for (std::size_t a = 0; a < kStateArrays.size(); ++a) {
    const StateArray& array = kStateArrays[a];
    std::vector<std::size_t> shape{rows};
    if (!array.components.empty()) shape.push_back(ids_.size());
    if (array.components.size() > 1) shape.push_back(array.components.size());
    const std::span<const double> values(values_[a]);
    arrays.push_back({std::string(array.name), shape, values.first(rows * array.row_values(ids_.size()))});
  }
  return arrays;
}

void RunArrays::Reserve(std::size_t rows) {
  for (std::size_t a = 0; a < kStateArrays.size(); ++a)
    values_[a].reserve(rows * kStateArrays[a].row_values(ids_.size()));
}

}  // namespace mascot
