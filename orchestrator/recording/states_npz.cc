#include "orchestrator/recording/states_npz.h"

#include <numeric>

namespace mascot {

StatesNpz::StatesNpz(const std::string& path, int agents, std::int64_t max_rows, bool commands)
    : npz_(path, static_cast<std::uint64_t>(max_rows)) {
  for (std::size_t a = 0; a < kStateArrays.size(); ++a) {
    const StateArray& array = kStateArrays[a];
    if (array.of_command && !commands) continue;
    std::vector<std::size_t> shape;
    if (!array.components.empty()) shape.push_back(static_cast<std::size_t>(agents));
    if (array.components.size() > 1) shape.push_back(array.components.size());
    columns_.push_back({a, npz_.AddArray(std::string(array.name), shape)});
    if (array.name != "t") continue;
    std::vector<std::int64_t> ids(static_cast<std::size_t>(agents));
    std::iota(ids.begin(), ids.end(), 1);
    npz_.AddConstant("id", ids);
  }
}

void StatesNpz::Append(const StateRow& row) {
  for (const Column& column : columns_) npz_.Append(column.handle, row.Values(column.array));
}

}  // namespace mascot
