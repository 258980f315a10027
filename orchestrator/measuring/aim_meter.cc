#include "orchestrator/measuring/aim_meter.h"

#include <algorithm>
#include <cmath>

#include "agent/laws/laws.h"

namespace mascot {

AimMeter::AimMeter(const Experiment& phase) : experiment_(phase), agreement_(phase), pursuit_(phase) { Adopt(phase); }

void AimMeter::Adopt(const Experiment& now) {
  const auto places_W = PlacesOf(now.law);
  formation_.offsets_m.assign(places_W.begin(), places_W.end());
  agreement_.Adopt(now);
  is_lost_.clear();
  for (const AgentConfig& agent : now.agents) is_lost_.push_back(agent.faults.is_lost());
}

void AimMeter::Add(std::span<const Motion> motions) {
  agreed_W_.clear();
  speed_m_per_s_ = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    agreed_W_.push_back(Agreed(i, motions[i]));
    if (is_lost_[i] == 0)
      speed_m_per_s_ = std::max(speed_m_per_s_, Along(experiment_.law.axes, motions[i].v_WB).norm());
  }
  agreement_.Add(agreed_W_);
  MeasureFormation(motions);
  pursuit_.Add(motions);
  ++rows_;
}

Eigen::Vector3d AimMeter::Agreed(std::size_t i, const Motion& motion) const {
  return formation_.offsets_m.empty() ? motion.p_WB : motion.p_WB - formation_.offsets_m[i];
}

void AimMeter::MeasureFormation(std::span<const Motion> motions) {
  if (formation_.offsets_m.empty()) return;
  double squares = 0;
  for (int id = 1; id <= experiment_.size(); ++id) {
    const auto i = static_cast<std::size_t>(id - 1);
    for (const Graph::Neighbour& heard : experiment_.graph.HeardBy(id)) {
      const auto j = static_cast<std::size_t>(heard.id - 1);
      if (is_lost_[i] != 0 || is_lost_[j] != 0) continue;
      squares += Along(experiment_.law.axes, Agreed(i, motions[i]) - Agreed(j, motions[j])).squaredNorm();
    }
  }
  formation_.final_rms_m =
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(experiment_.graph.edges(), 1)));
  if (2 * rows_ >= experiment_.ticks())
    formation_.worst_rms_m = std::max(formation_.worst_rms_m, formation_.final_rms_m);
}

Aim AimMeter::Result() const {
  Aim aim;
  aim.rows = rows_;
  aim.value_m = agreement_.mean_W();
  aim.final_disagreement_m = agreement_.disagreement_m();
  aim.final_speed_m_per_s = speed_m_per_s_;
  aim.settling_time_s = agreement_.settling_time_s();
  aim.rate_per_s = agreement_.rate_per_s();
  aim.minmax_edges = pursuit_.Result();
  if (!formation_.offsets_m.empty()) aim.formation = formation_;
  return aim;
}

}  // namespace mascot
