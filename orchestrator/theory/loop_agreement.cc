#include "orchestrator/theory/loop_agreement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "orchestrator/theory/loop_bands.h"
#include "orchestrator/theory/loop_team.h"

namespace mascot {
namespace {

constexpr double kSettlingOff = 0.03, kRateOff = 0.05;  // shares of what is predicted
constexpr double kValueOff = 0.01, kMet = 1e-3;         // of the disagreement at the start
// What the flights of bodies beside the model may differ by, of the same.
constexpr double kSettlingSpread = 0.05, kRateSpread = 0.1, kValueSpread = 0.02;

void Silence(std::string why, Prediction& prediction) {
  prediction.settling_time_s.reset();
  prediction.rate_per_s.reset();
  prediction.from_start = false;
  prediction.response.reset();
  if (prediction.silent.empty()) prediction.silent = std::move(why);
}

/// Whether what a flight comes to hangs on no more than is known of the bodies: flights beside it come to the same.
bool IsSure(const Experiment& experiment, const LoopAgreement& flown) {
  const auto alike = [](const std::optional<double>& a, const std::optional<double>& b, double share, double least) {
    if (!a || !b) return a.has_value() == b.has_value();
    return std::abs(*a - *b) <= share * std::abs(*a) + least;
  };
  const auto comes_to_the_same = [&](const LoopFlight& flight) {
    if (!flight.silent.empty()) return false;
    const LoopAgreement& other = flight.agreement;
    const double apart_m = (other.mean_W - flown.mean_W).head(CountOf(experiment.law.axes)).norm();
    return apart_m <= kValueSpread * flown.first_m && alike(flown.rate_per_s, other.rate_per_s, kRateSpread, 0) &&
           alike(flown.settling_time_s, other.settling_time_s, kSettlingSpread, 2 * experiment.period_s());
  };
  return comes_to_the_same(FlyBeside(experiment, comes_to_the_same).back());
}

/// Takes the times and the rate of the flight where those predicted are off. Returns whether any was.
bool JudgeTimes(const Experiment& experiment, const LoopAgreement& flown, Prediction& prediction) {
  const double off_s = kSettlingOff * *prediction.settling_time_s + experiment.period_s();
  bool is_off = false;
  if (flown.settling_time_s) {
    is_off = std::abs(*flown.settling_time_s - *prediction.settling_time_s) > off_s;
    if (is_off) prediction.settling_time_s = flown.settling_time_s;
  } else if (*prediction.settling_time_s + off_s < experiment.run.duration_s) {
    Silence("quadrotors, flown ahead with the lag and the limit of their tilt, do not settle by the end of the run",
            prediction);
    return true;
  }
  if (!prediction.rate_per_s || !flown.rate_per_s) return is_off;
  if (std::abs(*flown.rate_per_s - *prediction.rate_per_s) <= kRateOff * *prediction.rate_per_s) return is_off;
  prediction.rate_per_s = flown.rate_per_s;
  return true;
}

/// Takes the meeting point of the flight where that predicted is off. Returns whether it was.
bool JudgeValue(const Experiment& experiment, const LoopAgreement& flown, Prediction& prediction) {
  if (!prediction.value_m || experiment.law.leader > 0) return false;
  const Eigen::Index axes = CountOf(experiment.law.axes);
  const double off_m = (flown.mean_W - *prediction.value_m).head(axes).norm();
  const bool met = flown.last_m <= kMet * flown.first_m;
  if (!met || off_m <= kValueOff * flown.first_m) return false;
  prediction.value_m->head(axes) = flown.mean_W.head(axes);
  return true;
}

}  // namespace

void JudgeAgreementOnLoops(const Experiment& experiment, Prediction& prediction) {
  const auto flies = [](const AgentConfig& agent) { return agent.traits().has_airframe; };
  if (!prediction.from_start || !prediction.settling_time_s || prediction.on_average) return;
  if (std::ranges::none_of(experiment.agents, flies) || !WhyNotLoops(experiment).empty()) return;
  if (std::ranges::any_of(experiment.agents, &AgentConfig::has_own_law)) return;
  const LoopFlight flight = FlyLoops(experiment, {.turn = 0, .push = 0});
  std::string silent = flight.silent;
  if (silent.empty()) {
    const bool is_late = JudgeTimes(experiment, flight.agreement, prediction);
    const bool is_elsewhere = JudgeValue(experiment, flight.agreement, prediction);
    if (flight.is_tilt_cut && is_elsewhere)  // how it is cut is what the model knows least
      silent = "the limit of the tilt cuts what quadrotors are commanded, and moves where they meet";
    else if ((is_late || is_elsewhere || flight.is_tilt_cut) && !IsSure(experiment, flight.agreement))
      silent = "where and when quadrotors meet hangs on more than is known of them";
  }
  if (silent.empty()) {
    prediction.response = flight.agreement.response;
    return;
  }
  if (experiment.law.leader == 0) prediction.value_m.reset();
  Silence(std::move(silent), prediction);
}

}  // namespace mascot
