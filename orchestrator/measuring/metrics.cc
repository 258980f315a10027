#include "orchestrator/measuring/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "agent/laws.h"
#include "agent/python.h"

namespace mascot {

Metrics::Metrics(const Experiment& experiment)
    : experiment_(experiment),
      agreement_(experiment),
      pursuit_(experiment),
      min_separation2_(std::numeric_limits<double>::infinity()) {
  const SuppressedPythonOutput suppressed;  // the laws run a second time; discard what they print
  if (experiment.output.fidelity) ideal_.emplace(experiment);
  accelerated_ = std::ranges::count_if(experiment.agents, std::not_fn(IsCommandedByVelocity));
  TakePlaces(experiment.law);
  TakeSafety(experiment);
}

void Metrics::TakePlaces(const LawConfig& law) {
  const auto places_W = PlacesOf(law);
  formation_.offsets_m.assign(places_W.begin(), places_W.end());
}

void Metrics::TakeSafety(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents) has_safety_ = has_safety_ || agent.law.safety;
}

void Metrics::Adopt(std::shared_ptr<const Experiment> now) {
  TakePlaces(now->law);
  TakeSafety(*now);
  now_ = std::move(now);
}

void Metrics::Add(const DecodedRow& row) {
  MeasureAgreement(row.motions);
  MeasureControl(row.commands);
  MeasureSeparation(row.motions);
  MeasureFidelity(row.motions);
  MeasurePath(row.motions);
  MeasureFormation(row.motions);
  pursuit_.Add(row.motions);
  ++rows_;
}

Eigen::Vector3d Metrics::Agreed(std::size_t i, const Motion& motion) const {
  return formation_.offsets_m.empty() ? motion.p_WB : motion.p_WB - formation_.offsets_m[i];
}

void Metrics::MeasureAgreement(std::span<const Motion> motions) {
  agreed_W_.clear();
  speed_m_per_s_ = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    agreed_W_.push_back(Agreed(i, motions[i]));
    speed_m_per_s_ = std::max(speed_m_per_s_, Along(experiment_.law.axes, motions[i].v_WB).norm());
  }
  agreement_.Add(agreed_W_);
}

void Metrics::MeasureControl(std::span<const Command> commands) {
  effort_m2_per_s3_ += newest_effort_m2_per_s3_;  // that of the previous row; the last commands are never applied
  newest_effort_m2_per_s3_ = 0;
  bool is_feasible = true;
  for (const Command& command : commands) {
    newest_effort_m2_per_s3_ += command.a_limited_W.squaredNorm() * experiment_.period_s();
    saturated_ += (command.flags & kAccelerationLimited) != 0;
    tilt_limited_ += (command.flags & kTiltLimited) != 0;
    rotor_limited_ += (command.flags & kRotorLimited) != 0;
    filtered_ += (command.flags & kSafetyFiltered) != 0;
    is_feasible = is_feasible && (command.flags & kSafetyInfeasible) == 0;
  }
  infeasible_ticks_ += !is_feasible;
}

/// Updates the smallest separation. Agents are sorted by x, so that the inner loop ends where x alone differs by more.
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

// A law may fail on ideal bodies only, for example because two agents are at exactly the same position. The run goes
// on; only the comparison ends.
void Metrics::StepIdeal() try {
  const SuppressedPythonOutput suppressed;
  ideal_->Step();
} catch (const std::exception& failure) {
  ideal_failure_ = failure.what();
  ideal_.reset();
}

void Metrics::MeasureFidelity(std::span<const Motion> motions) {
  if (ideal_ && rows_ > 0) StepIdeal();
  if (!ideal_) return;
  if (now_) ideal_->Adopt(std::exchange(now_, nullptr));  // after the step that leads to this row
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const double deviation2 = (motions[i].p_WB - ideal_->p_W(static_cast<int>(i) + 1)).squaredNorm();
    squared_deviation_ += deviation2;
    max_deviation2_ = std::max(max_deviation2_, deviation2);
  }
}

void Metrics::MeasurePath(std::span<const Motion> motions) {
  for (std::size_t i = 0; i < last_p_W_.size(); ++i) path_m_ += (motions[i].p_WB - last_p_W_[i]).norm();
  last_p_W_.resize(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) last_p_W_[i] = motions[i].p_WB;
}

void Metrics::MeasureFormation(std::span<const Motion> motions) {
  if (formation_.offsets_m.empty()) return;
  double squares = 0;
  for (int id = 1; id <= experiment_.size(); ++id) {
    const auto i = static_cast<std::size_t>(id - 1);
    for (const Graph::Neighbour& heard : experiment_.graph.HeardBy(id)) {
      const auto j = static_cast<std::size_t>(heard.id - 1);
      squares += Along(experiment_.law.axes, Agreed(i, motions[i]) - Agreed(j, motions[j])).squaredNorm();
    }
  }
  formation_.final_rms_m =
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(experiment_.graph.edges(), 1)));
  if (2 * rows_ >= experiment_.ticks())
    formation_.worst_rms_m = std::max(formation_.worst_rms_m, formation_.final_rms_m);
}

Measured Metrics::Result() const {
  Measured result;
  result.rows = rows_;
  if (rows_ == 0) return result;
  const double agents = experiment_.size();
  const double samples = agents * static_cast<double>(rows_);
  result.value_m = agreement_.mean_W();
  result.final_disagreement_m = agreement_.disagreement_m();
  result.final_speed_m_per_s = speed_m_per_s_;
  result.settling_time_s = agreement_.settling_time_s();
  result.rate_per_s = agreement_.rate_per_s();
  result.minmax_edges = pursuit_.Result();
  if (accelerated_ > 0) result.effort_m2_per_s3 = effort_m2_per_s3_ / static_cast<double>(accelerated_);
  result.saturated_fraction = static_cast<double>(saturated_) / samples;
  result.tilt_limited_fraction = static_cast<double>(tilt_limited_) / samples;
  result.rotor_limited_fraction = static_cast<double>(rotor_limited_) / samples;
  if (experiment_.size() > 1) result.min_separation_m = std::sqrt(min_separation2_);
  if (has_safety_) {
    result.filtered_fraction = static_cast<double>(filtered_) / samples;
    result.infeasible_ticks = infeasible_ticks_;
  }
  if (ideal_) result.fidelity = {.rms_m = std::sqrt(squared_deviation_ / samples), .max_m = std::sqrt(max_deviation2_)};
  result.fidelity_failure = ideal_failure_;
  if (!formation_.offsets_m.empty()) result.formation = formation_;
  result.travelled_m = path_m_ / agents;
  return result;
}

}  // namespace mascot
