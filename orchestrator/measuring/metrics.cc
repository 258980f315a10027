#include "orchestrator/measuring/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "agent/laws/laws.h"
#include "agent/user_code/law_output.h"

namespace mascot {
namespace {

/// A fault for which there are no ideal bodies, in words; empty: there is none.
std::string FaultOfBodies(const Experiment& now) {
  for (const AgentConfig& agent : now.agents) {
    if (agent.law.params->once_per_process)
      return fmt::format("a process can have the law of agent {} only once", agent.id);
    if (agent.faults.is_lost()) return fmt::format("agent {} was lost", agent.id);
    for (const PartFault& part : agent.faults.parts)
      if (part.fault.of == FaultPart::kMotor) return fmt::format("a motor of agent {} failed", agent.id);
  }
  return "";
}

/// The number of agents that are commanded accelerations.
std::int64_t CommandedByAcceleration(const Experiment& experiment) {
  return std::ranges::count_if(experiment.agents, std::not_fn(IsCommandedByVelocity));
}

}  // namespace

Metrics::Metrics(const Experiment& experiment, Crew& crew) : experiment_(experiment) {
  const SuppressedLawOutput suppressed;  // the laws run a second time; discard what they print
  if (experiment.output.fidelity) fault_ = FaultOfBodies(experiment);
  if (experiment.output.fidelity && fault_.empty()) ideal_.emplace(experiment, crew);
  accelerated_ = CommandedByAcceleration(experiment);
  Take(experiment);
}

void Metrics::Take(const Experiment& experiment) {
  axes_.clear();
  is_lost_.clear();
  for (const AgentConfig& agent : experiment.agents) {
    has_safety_ = has_safety_ || agent.law.safety;
    axes_.push_back(agent.law.axes);
    is_lost_.push_back(agent.faults.is_lost());
  }
}

void Metrics::Adopt(std::shared_ptr<const Experiment> now) {
  accelerated_ = std::max(accelerated_, CommandedByAcceleration(*now));
  Take(*now);
  if (ideal_) fault_ = FaultOfBodies(*now);
  if (!fault_.empty()) ideal_.reset();
  now_ = std::move(now);
}

void Metrics::Add(const DecodedRow& row) {
  MeasureControl(row);
  separation_.Add(row.motions, axes_);
  MeasureFidelity(row);
  MeasurePath(row.motions);
  ++rows_;
}

void Metrics::MeasureControl(const DecodedRow& row) {
  effort_m2_per_s3_ += newest_effort_m2_per_s3_;  // that of the previous row; the last commands are never applied
  newest_effort_m2_per_s3_ = 0;
  bool is_feasible = true;
  for (std::size_t i = 0; i < row.commands.size(); ++i) {
    if (is_lost_[i] != 0) continue;
    const Command& command = row.commands[i];
    newest_effort_m2_per_s3_ += command.a_limited_W.squaredNorm() * experiment_.period_s();
    saturated_ += (command.flags & kAccelerationLimited) != 0;
    tilt_limited_ += (command.flags & kTiltLimited) != 0;
    rotor_limited_ += (command.flags & kRotorLimited) != 0;
    filtered_ += (command.flags & kSafetyFiltered) != 0;
    is_feasible = is_feasible && (command.flags & kSafetyInfeasible) == 0;
  }
  infeasible_ticks_ += !is_feasible;
}

// A law may fail on ideal bodies only, for example because two agents are at exactly the same position. The run goes
// on; only the comparison ends.
void Metrics::StepIdeal() try {
  const SuppressedLawOutput suppressed;
  ideal_->Step();
} catch (const std::exception& failure) {
  ideal_failure_ = failure.what();
  ideal_.reset();
}

void Metrics::MeasureFidelity(const DecodedRow& row) {
  if (ideal_ && rows_ > 0) StepIdeal();
  if (!ideal_) return;
  if (now_) ideal_->Adopt(std::exchange(now_, nullptr));  // after the step that leads to this row
  for (std::size_t i = 0; i < row.motions.size(); ++i) {
    if (!row.actions[i].empty()) ideal_->Act(static_cast<int>(i) + 1, row.actions[i]);
    const double deviation2 = (row.motions[i].p_WB - ideal_->p_W(static_cast<int>(i) + 1)).squaredNorm();
    squared_deviation_ += deviation2;
    max_deviation2_ = std::max(max_deviation2_, deviation2);
    if (const auto phase = phases_.find(static_cast<int>(i) + 1); phase != phases_.end()) {
      GapSums& gap = gaps_[*phase];
      ++gap.rows;
      gap.squared += deviation2;
      gap.max2 = std::max(gap.max2, deviation2);
    }
  }
}

void Metrics::MeasurePath(std::span<const Motion> motions) {
  for (std::size_t i = 0; i < last_p_W_.size(); ++i) path_m_ += (motions[i].p_WB - last_p_W_[i]).norm();
  last_p_W_.resize(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) last_p_W_[i] = motions[i].p_WB;
}

Measured Metrics::Result() const {
  Measured result;
  result.rows = rows_;
  if (rows_ == 0) return result;
  const double agents = experiment_.size();
  const double samples = agents * static_cast<double>(rows_);
  if (accelerated_ > 0) result.effort_m2_per_s3 = effort_m2_per_s3_ / static_cast<double>(accelerated_);
  result.saturated_fraction = static_cast<double>(saturated_) / samples;
  result.tilt_limited_fraction = static_cast<double>(tilt_limited_) / samples;
  result.rotor_limited_fraction = static_cast<double>(rotor_limited_) / samples;
  if (experiment_.size() > 1) {
    result.min_separation_m = separation_.in_space_m();
    result.min_separation_along_axes_m = separation_.along_axes_m();
  }
  if (has_safety_) {
    result.filtered_fraction = static_cast<double>(filtered_) / samples;
    result.infeasible_ticks = infeasible_ticks_;
  }
  if (ideal_) result.fidelity = {.rms_m = std::sqrt(squared_deviation_ / samples), .max_m = std::sqrt(max_deviation2_)};
  for (const auto& [which, gap] : gaps_)
    result.gaps.push_back({which.first,
                           which.second,
                           gap.rows,
                           {std::sqrt(gap.squared / static_cast<double>(gap.rows)), std::sqrt(gap.max2)}});
  if (!ideal_) result.gaps.clear();
  result.fidelity_failure = ideal_failure_;
  result.fidelity_fault = fault_;
  result.travelled_m = path_m_ / agents;
  return result;
}

}  // namespace mascot
