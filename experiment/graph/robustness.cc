#include "experiment/graph/robustness.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace mascot {

// A group is a set of bits. reach[S] is the most agents outside S that an agent of S hears, least[S] the smallest reach
// of a group within S. Then r is the smallest max(reach[S], least[not S]).
std::optional<int> RobustnessOf(const Graph& graph) {
  const int count = graph.size();
  if (count > kMaxRobustness) return std::nullopt;
  if (count < 2) return 1;
  std::vector<std::uint32_t> heard(static_cast<std::size_t>(count));
  for (int id = 1; id <= count; ++id)
    for (const Graph::Neighbour& j : graph.HeardBy(id)) heard[static_cast<std::size_t>(id - 1)] |= 1u << (j.id - 1);
  const std::uint32_t all = (1u << count) - 1;
  std::vector<int> reach(all + 1), least(all + 1, count);
  for (std::uint32_t group = 1; group <= all; ++group) {
    for (std::size_t i = 0; i < heard.size(); ++i) {
      if ((group >> i & 1u) == 0) continue;
      reach[group] = std::max(reach[group], std::popcount(heard[i] & ~group));
      least[group] = std::min(least[group], least[group & ~(1u << i)]);
    }
    least[group] = std::min(least[group], reach[group]);
  }
  int robustness = count;
  for (std::uint32_t group = 1; group < all; ++group)
    robustness = std::min(robustness, std::max(reach[group], least[all & ~group]));
  return robustness;
}

}  // namespace mascot
