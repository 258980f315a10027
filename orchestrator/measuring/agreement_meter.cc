#include "orchestrator/measuring/agreement_meter.h"

#include <algorithm>

namespace mascot {

void AgreementMeter::Add(std::span<const Eigen::Vector3d> q_W) {
  mean_W_.setZero();
  for (const Eigen::Vector3d& q : q_W) mean_W_ += q / static_cast<double>(q_W.size());
  const int leader = experiment_.law.leader;
  const Eigen::Vector3d centre_W = leader > 0 ? q_W[static_cast<std::size_t>(leader - 1)] : mean_W_;
  disagreement_m_ = 0;
  for (const Eigen::Vector3d& q : q_W)
    disagreement_m_ = std::max(disagreement_m_, Along(experiment_.law.axes, q - centre_W).norm());
  decay_.Add(experiment_.time_s(ticks_), disagreement_m_);
  if (ticks_ == 0) first_disagreement_m_ = disagreement_m_;
  constexpr double kSettledFraction = 0.02;
  if (disagreement_m_ > kSettledFraction * first_disagreement_m_) last_unsettled_ = ticks_;
  ++ticks_;
}

std::optional<double> AgreementMeter::settling_time_s() const {
  if (first_disagreement_m_ == 0 || last_unsettled_ >= ticks_ - 1) return std::nullopt;
  return experiment_.time_s(last_unsettled_ + 1);
}

}  // namespace mascot
