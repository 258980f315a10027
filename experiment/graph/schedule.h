#pragma once

#include <span>
#include <utility>
#include <vector>

#include "experiment/graph/graph.h"

namespace mascot {

/// Who hears whom when: a graph until the next one takes over, from the first again if it repeats.
class Schedule {
 public:
  struct Phase {
    double at_s = 0;
    Graph graph;
  };

  /// One empty graph.
  Schedule() : Schedule({{0, Graph({})}}, 0, 0) {}
  /// `phases`: the first from 0 s, at_s increasing. `repeat_s`: after this time it starts over; 0: never.
  /// `range_m`: edges work only between agents closer than this; 0: at any distance.
  Schedule(std::vector<Phase> phases, double repeat_s, double range_m)
      : phases_(std::move(phases)), repeat_s_(repeat_s), range_m_(range_m) {}

  std::span<const Phase> phases() const { return phases_; }
  double repeat_s() const { return repeat_s_; }
  double range_m() const { return range_m_; }
  /// One graph for ever, at any distance.
  bool IsConstant() const { return phases_.size() == 1 && range_m_ == 0; }
  /// The graph at simulated time `t_s`, distance aside. A phase begins with the tick at which it begins, whatever the
  /// rounding of its time.
  const Graph& At(double t_s) const;
  /// Every edge that some phase has, with the weight it has there first.
  Graph Union() const;

 private:
  std::vector<Phase> phases_;
  double repeat_s_;
  double range_m_;
};

/// The keys of [graph].
std::span<const Key> ScheduleKeys();
/// Reads [graph] for agents that start at `p_W`: exactly one of topology, laplacian, adjacency, edges, random; then the
/// same in every [[graph.schedule]], repeat_s and range_m. `seed` feeds random graphs. With no agents, not known for a
/// mistake elsewhere, sizes are not checked and the graphs are empty.
Schedule ReadSchedule(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed);

}  // namespace mascot
