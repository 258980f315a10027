#include "orchestrator/measuring/agreement_meter.h"

#include <algorithm>
#include <vector>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

/// The indices of the agents that count: those that neither lie nor are lost, or all if there are none.
std::vector<std::size_t> Counting(const Experiment& experiment) {
  std::vector<std::size_t> counting;
  counting.reserve(experiment.agents.size());
  const auto add = [&](bool all) {
    for (std::size_t i = 0; i < experiment.agents.size(); ++i)
      if (all || (!experiment.agents[i].lie && !experiment.agents[i].faults.is_lost())) counting.push_back(i);
  };
  add(/*all=*/false);
  if (counting.empty()) add(/*all=*/true);
  return counting;
}

// q_W(i): what the agents agree on, by index, in W.

template <class Places>
Eigen::Vector3d MeanOf(const Places& q_W, std::span<const std::size_t> counting) {
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
  for (const std::size_t i : counting) mean_W += q_W(i) / static_cast<double>(counting.size());
  return mean_W;
}

template <class Places>
double LargestDistance(const LawConfig& law, const Places& q_W, std::span<const std::size_t> counting,
                       const Eigen::Vector3d& mean_W) {
  const Eigen::Vector3d centre_W = law.leader > 0 ? q_W(static_cast<std::size_t>(law.leader - 1)) : mean_W;
  double largest_m = 0;
  for (const std::size_t i : counting) largest_m = std::max(largest_m, Along(law.axes, q_W(i) - centre_W).norm());
  return largest_m;
}

}  // namespace

AgreementMeter::AgreementMeter(const Experiment& experiment)
    : experiment_(experiment), counting_(Counting(experiment)) {}

void AgreementMeter::Adopt(const Experiment& now) { counting_ = Counting(now); }

double DisagreementOf(const Experiment& experiment, std::span<const Motion> motions) {
  const auto places_W = PlacesOf(experiment.law);
  const auto q_W = [&](std::size_t i) -> Eigen::Vector3d {
    if (i < places_W.size()) return motions[i].p_WB - places_W[i];
    return motions[i].p_WB;
  };
  const std::vector<std::size_t> counting = Counting(experiment);
  return LargestDistance(experiment.law, q_W, counting, MeanOf(q_W, counting));
}

void AgreementMeter::Add(std::span<const Eigen::Vector3d> q_W) {
  const auto of_agent = [&](std::size_t i) -> const Eigen::Vector3d& { return q_W[i]; };
  mean_W_ = MeanOf(of_agent, counting_);
  disagreement_m_ = LargestDistance(experiment_.law, of_agent, counting_, mean_W_);
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
