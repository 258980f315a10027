#include "orchestrator/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mascot {
namespace {

constexpr double kSettledFraction = 0.02;

/// The part of `v` that the law governs.
Eigen::Vector3d Along(Axes axes, Eigen::Vector3d v) {
  if (axes == Axes::kXy) v.z() = 0;
  return v;
}

}  // namespace

Metrics::Metrics(Experiment& experiment)
    : experiment_(experiment), ideal_(experiment), min_separation2_(std::numeric_limits<double>::infinity()) {}

void Metrics::Add(std::span<const Motion> motions, std::span<const Command> commands) {
  MeasureAgreement(motions);
  MeasureControl(commands);
  MeasureSeparation(motions);
  MeasureFidelity(motions);
  ++rows_;
}

void Metrics::MeasureAgreement(std::span<const Motion> motions) {
  Motion centre;
  for (const Motion& motion : motions) {
    centre.p_WB += motion.p_WB;
    centre.v_WB += motion.v_WB;
  }
  centre.p_WB /= static_cast<double>(motions.size());
  centre.v_WB /= static_cast<double>(motions.size());
  mean_W_ = centre.p_WB;
  if (const int leader = experiment_.law.leader; leader > 0) centre = motions[static_cast<std::size_t>(leader - 1)];
  disagreement_m_ = speed_m_per_s_ = 0;
  for (const Motion& motion : motions) {
    disagreement_m_ = std::max(disagreement_m_, Along(experiment_.law.axes, motion.p_WB - centre.p_WB).norm());
    speed_m_per_s_ = std::max(speed_m_per_s_, Along(experiment_.law.axes, motion.v_WB).norm());
  }
  if (rows_ == 0) first_disagreement_m_ = disagreement_m_;
  if (disagreement_m_ > kSettledFraction * first_disagreement_m_) last_unsettled_ = rows_;
}

void Metrics::MeasureControl(std::span<const Command> commands) {
  for (const Command& command : commands) {
    effort_ += command.a_limited_W.squaredNorm() * experiment_.period_s();
    saturated_ += (command.flags & kAccelerationLimited) != 0;
  }
}

/// Closest pair: agents in order of x need only be compared while x alone does not already part them.
void Metrics::MeasureSeparation(std::span<const Motion> motions) {
  by_x_.clear();
  for (const Motion& motion : motions) by_x_.push_back(motion.p_WB);
  std::sort(by_x_.begin(), by_x_.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  for (std::size_t i = 0; i < by_x_.size(); ++i)
    for (std::size_t j = i + 1; j < by_x_.size(); ++j) {
      const double dx = by_x_[j].x() - by_x_[i].x();
      if (dx * dx >= min_separation2_) break;
      min_separation2_ = std::min(min_separation2_, (by_x_[j] - by_x_[i]).squaredNorm());
    }
}

void Metrics::MeasureFidelity(std::span<const Motion> motions) {
  if (rows_ > 0) ideal_.Step();
  last_p_W_.resize(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const double deviation2 = (motions[i].p_WB - ideal_.p_W(static_cast<int>(i) + 1)).squaredNorm();
    squared_deviation_ += deviation2;
    max_deviation2_ = std::max(max_deviation2_, deviation2);
    if (rows_ > 0) path_m_ += (motions[i].p_WB - last_p_W_[i]).norm();
    last_p_W_[i] = motions[i].p_WB;
  }
}

Measured Metrics::Result() const {
  Measured result;
  result.rows = rows_;
  if (rows_ == 0) return result;
  const double agents = experiment_.size();
  const double samples = agents * static_cast<double>(rows_);
  result.value_m = mean_W_;
  result.final_disagreement_m = disagreement_m_;
  result.final_speed_m_per_s = speed_m_per_s_;
  if (last_unsettled_ < rows_ - 1) result.settling_time_s = experiment_.time_s(last_unsettled_ + 1);
  result.effort_m2_per_s3 = effort_ / agents;
  result.saturated_fraction = static_cast<double>(saturated_) / samples;
  if (experiment_.size() > 1) result.min_separation_m = std::sqrt(min_separation2_);
  result.fidelity_rms_m = std::sqrt(squared_deviation_ / samples);
  result.fidelity_max_m = std::sqrt(max_deviation2_);
  result.travelled_m = path_m_ / agents;
  return result;
}

}  // namespace mascot
