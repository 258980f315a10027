#include "orchestrator/measuring/pursuit_meter.h"

#include <algorithm>

#include "agent/laws/laws.h"

namespace mascot {

PursuitMeter::PursuitMeter(const Experiment& experiment) : experiment_(experiment) {
  const std::optional<PursuitForm> pursuit = PursuitFormOf(experiment.law);
  if (!pursuit) return;
  for (const AgentConfig& agent : experiment.agents) {
    const int parent = pursuit->parent[static_cast<std::size_t>(agent.id - 1)];
    if (parent != 0 && !agent.has_own_law) pursuits_.push_back({.child = agent.id, .parent = parent});
  }
}

void PursuitMeter::Add(std::span<const Motion> motions) {
  const Eigen::Index axes = CountOf(experiment_.law.axes);
  for (Pursuit& pursuit : pursuits_) {
    const Motion& child = motions[static_cast<std::size_t>(pursuit.child - 1)];
    const Motion& parent = motions[static_cast<std::size_t>(pursuit.parent - 1)];
    const double apart_m = (child.p_WB - parent.p_WB).head(axes).cwiseAbs().maxCoeff();
    if (apart_m > kCaughtUp_m) pursuit.last_apart = rows_;
    const bool ends = 10 * rows_ > 9 * experiment_.ticks();
    pursuit.end_m = ends ? std::max(apart_m, pursuit.end_m) : apart_m;
  }
  ++rows_;
}

std::vector<PursuitMeter::Edge> PursuitMeter::Result() const {
  std::vector<Edge> edges;
  for (const Pursuit& pursuit : pursuits_) {
    edges.push_back({pursuit.child, pursuit.parent, std::nullopt, pursuit.end_m});
    if (pursuit.last_apart < rows_ - 1) edges.back().time_s = experiment_.time_s(pursuit.last_apart + 1);
  }
  return edges;
}

}  // namespace mascot
