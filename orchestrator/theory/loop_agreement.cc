#include "orchestrator/theory/loop_agreement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "orchestrator/theory/loop_bands.h"
#include "orchestrator/theory/loop_team.h"

namespace mascot {
namespace {

constexpr double kSettlingOff = 0.03, kRateOff = 0.05;  // shares of what is predicted
constexpr double kValueOff = 0.01, kMet = 1e-3;         // of the disagreement at the start

void Silence(std::string why, Prediction& prediction) {
  prediction.settling_time_s.reset();
  prediction.rate_per_s.reset();
  prediction.from_start = false;
  if (prediction.silent.empty()) prediction.silent = std::move(why);
}

void JudgeTimes(const Experiment& experiment, const LoopAgreement& flown, Prediction& prediction) {
  const double off_s = kSettlingOff * *prediction.settling_time_s + experiment.period_s();
  if (flown.settling_time_s) {
    if (std::abs(*flown.settling_time_s - *prediction.settling_time_s) > off_s)
      prediction.settling_time_s = flown.settling_time_s;
  } else if (*prediction.settling_time_s + off_s < experiment.run.duration_s) {
    return Silence(
        "quadrotors, flown ahead with the lag and the limit of their tilt, do not settle by the end of the run",
        prediction);
  }
  if (!prediction.rate_per_s || !flown.rate_per_s) return;
  if (std::abs(*flown.rate_per_s - *prediction.rate_per_s) > kRateOff * *prediction.rate_per_s)
    prediction.rate_per_s = flown.rate_per_s;
}

void JudgeValue(const Experiment& experiment, const LoopAgreement& flown, Prediction& prediction) {
  if (!prediction.value_m || experiment.law.leader > 0) return;
  const Eigen::Index axes = CountOf(experiment.law.axes);
  const double off_m = (flown.mean_W - *prediction.value_m).head(axes).norm();
  const bool met = flown.last_m <= kMet * flown.first_m;
  if (!met || off_m <= kValueOff * flown.first_m) return;
  prediction.value_m->head(axes) = flown.mean_W.head(axes);
}

}  // namespace

void JudgeAgreementOnLoops(const Experiment& experiment, Prediction& prediction) {
  const auto flies = [](const AgentConfig& agent) { return agent.traits().has_airframe; };
  if (!prediction.from_start || !prediction.settling_time_s || prediction.on_average) return;
  if (std::ranges::none_of(experiment.agents, flies) || !WhyNotLoops(experiment).empty()) return;
  if (std::ranges::any_of(experiment.agents, &AgentConfig::has_own_law)) return;
  const LoopFlight flight = FlyLoops(experiment, {.turn = 0, .push = 0});
  if (!flight.silent.empty()) {
    if (experiment.law.leader == 0) prediction.value_m.reset();
    return Silence(flight.silent, prediction);
  }
  JudgeTimes(experiment, flight.agreement, prediction);
  JudgeValue(experiment, flight.agreement, prediction);
}

}  // namespace mascot
