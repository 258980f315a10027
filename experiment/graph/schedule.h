#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "experiment/graph/graph.h"

namespace mascot {

/// The graph over time: each phase has a graph until the next phase begins. After the last phase the schedule may start
/// again. Copies share the phases.
class Schedule {
 public:
  struct Phase {
    double at_s = 0;
    Graph graph;
  };

  /// One empty graph.
  Schedule() : Schedule({{0, Graph({})}}, 0, 0) {}
  /// `phases`: the first begins at 0 s, at_s increases. `repeat_s`: after this time it starts over; 0: never.
  /// `range_m`: edges work only between agents closer than this; 0: at any distance.
  Schedule(std::vector<Phase> phases, double repeat_s, double range_m)
      : phases_(std::make_shared<const std::vector<Phase>>(std::move(phases))),
        repeat_s_(repeat_s),
        range_m_(range_m) {}

  /// The same with another range.
  Schedule WithRange(double range_m) const {
    Schedule other = *this;
    other.range_m_ = range_m;
    return other;
  }

  std::span<const Phase> phases() const { return *phases_; }
  double repeat_s() const { return repeat_s_; }
  double range_m() const { return range_m_; }
  /// True if there is one graph for the whole run, at any distance.
  bool IsConstant() const { return phases_->size() == 1 && range_m_ == 0; }
  /// The graph at simulated time `t_s`, without the range. A rounding error in `t_s` does not delay a phase by a tick.
  const Graph& At(double t_s) const;
  /// The edges of all phases, each with the weight in its first phase.
  Graph Union() const;

 private:
  std::shared_ptr<const std::vector<Phase>> phases_;  // never null, nor empty
  double repeat_s_;
  double range_m_;
};

/// The keys of [graph].
std::span<const Key> ScheduleKeys();
/// Reads graph.range_m; 0: there is none.
double ReadRange(Section& graph);
/// Reads [graph]: one graph (ReadGraph), then one for each [[graph.schedule]], repeat_s and range_m. `p_W`: where the
/// agents start, in W (m). `seed`: for random graphs. With no agents (unknown because of a mistake elsewhere) sizes are
/// not checked and the graphs are empty.
Schedule ReadSchedule(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed);

}  // namespace mascot
