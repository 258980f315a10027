// What the filter of [law.safety] (agent/safety.cc) promises, if every agent hears all others at once, and its body
// does as it is told. Distances are along law.axes: with heights held, in the plane. T is the control period, D =
// distance_m:
//   driven by velocity      h(k+1) = h + 2 T dp.du + T^2 |du|^2 >= (1 - gamma T) h(k): no loss if gamma T <= 1
//   driven by acceleration  on h = 0, full braking stays on h = 0 from tick to tick; only the last tick before D, in
//                           which agents come to rest, takes distance: at most (a_i + a_j) T^2 / 8 if gamma T <= 1/2
#include "orchestrator/theory/safety.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/rounding.h"
#include "agent/safety.h"

namespace mascot {
namespace {

bool IsByVelocity(const AgentConfig& agent) { return agent.traits().driven_by == Wanted::kVelocity; }

/// A property of pairs: how many have it, and the first of them.
struct Pairs {
  int i = 0, j = 0, count = 0;
  void Add(const AgentConfig& a, const AgentConfig& b) {
    if (count++ > 0) return;
    i = a.id;
    j = b.id;
  }
  /// "agents 1 and 2 (and 3 other pairs) WHAT"
  std::string Text(std::string_view what) const {
    const std::string others = count > 2    ? fmt::format(" (and {} other pairs)", count - 1)
                               : count == 2 ? " (and another pair)"
                                            : "";
    return fmt::format("agents {} and {}{} {}", i, j, others, what);
  }
};

/// What is found out by looking at each pair.
struct OfPairs {
  Pairs deaf, close, fast, touching;
  double kept_m = std::numeric_limits<double>::infinity();
};

/// Half of the length of a body in the plane.
double Reach_m(const AgentConfig& agent) {
  return agent.traits().has_airframe ? agent.size_m().head<2>().norm() / 2 : kBallRadius_m;
}

OfPairs Look(const Experiment& experiment) {
  OfPairs found;
  for (const AgentConfig& a : experiment.agents) {
    for (const AgentConfig& b : std::span(experiment.agents).subspan(static_cast<std::size_t>(a.id))) {
      if (!experiment.graph.Hears(a.id, b.id) || !experiment.graph.Hears(b.id, a.id)) found.deaf.Add(a, b);
      if (!a.law.safety || !b.law.safety) continue;
      const double D_m = std::min(a.law.safety->distance_m, b.law.safety->distance_m);
      const double braking = BrakingOf(a) + BrakingOf(b);
      const Eigen::Vector3d dp_W = Along(a.law.axes, a.p_W - b.p_W), dv_W = Along(a.law.axes, a.v_W - b.v_W);
      const double d_m = dp_W.norm();
      if (d_m < D_m)
        found.close.Add(a, b);
      else if (braking > 0 && std::sqrt(2 * braking * (d_m - D_m)) * d_m + dp_W.dot(dv_W) < 0)
        found.fast.Add(a, b);
      if (experiment.physics.collisions && D_m < Reach_m(a) + Reach_m(b)) found.touching.Add(a, b);
      found.kept_m = std::min(found.kept_m, D_m - braking * experiment.period_s() * experiment.period_s() / 8);
    }
  }
  return found;
}

/// The reasons why no distance is promised that lie in single agents or in the experiment.
void AddReasons(const Experiment& experiment, std::vector<std::string>& reasons) {
  const std::vector<AgentConfig>& agents = experiment.agents;
  const auto bare = std::ranges::find_if(agents, [](const AgentConfig& a) { return !a.law.safety; });
  if (bare != agents.end())
    reasons.push_back(fmt::format("agent {} has no filter, and keeps no share of it", bare->id));
  if (std::string why = WhyNotAllHeard(experiment); !why.empty()) reasons.push_back(std::move(why));
  if (!experiment.sensors.own.IsNone() || !experiment.sensors.heard.IsNone() || experiment.sensors.own_delay_s > 0)
    reasons.emplace_back("what agents measure is noisy or late");
  if (experiment.run.mode == Mode::kRealtime) reasons.emplace_back("commands may be late in real time");
  if (std::ranges::any_of(agents, [&](const AgentConfig& a) { return a.law.axes != agents.front().law.axes; }))
    reasons.emplace_back("agents have different law.axes");
  if (std::ranges::any_of(agents, [](const AgentConfig& a) { return a.traits().rolls; }))
    reasons.emplace_back("a unicycle turns before its centre moves as it is told");
  const auto by_velocity = std::ranges::count_if(agents, IsByVelocity);
  if (by_velocity > 0 && by_velocity < experiment.size())
    reasons.emplace_back("some agents are driven by velocity, others by acceleration");
  for (const AgentConfig& agent : agents) {
    const double most = (IsByVelocity(agent) ? 1.0 : 0.5) * experiment.control.rate_hz;
    if (!agent.law.safety || agent.law.safety->gamma <= most) continue;
    reasons.push_back(fmt::format("a gamma of {:g} 1/s is more than the {:g} 1/s that control.rate_hz can keep",
                                  agent.law.safety->gamma, most));
    return;
  }
}

void Assume(const Experiment& experiment, SafetyPrediction& prediction) {
  prediction.assumes_safe_commands = experiment.size() > 2 && !std::ranges::all_of(experiment.agents, IsByVelocity);
  prediction.assumes_prompt_bodies =
      std::ranges::any_of(experiment.agents, [](const AgentConfig& a) { return a.traits().has_airframe; });
  std::string& text = prediction.assumes;
  if (prediction.assumes_safe_commands) text = "agents always find a safe command";
  if (prediction.assumes_prompt_bodies)
    text += fmt::format("{}quadrotors accelerate as soon as they are told", text.empty() ? "" : " and ");
}

}  // namespace

std::optional<SafetyPrediction> PredictSafety(const Experiment& experiment) {
  if (std::ranges::none_of(experiment.agents, [](const AgentConfig& a) { return a.law.safety.has_value(); }))
    return std::nullopt;
  const OfPairs found = Look(experiment);
  const double kept_m = found.kept_m - RoundingShare(experiment) * (LargestStart_m(experiment) + found.kept_m);
  std::vector<std::string> reasons;
  if (found.deaf.count > 0) reasons.push_back(found.deaf.Text("do not both hear each other"));
  AddReasons(experiment, reasons);
  if (found.close.count > 0) reasons.push_back(found.close.Text("start closer than law.safety.distance_m"));
  if (found.fast.count > 0) reasons.push_back(found.fast.Text("start too fast to stop before law.safety.distance_m"));
  if (kept_m <= 0)
    reasons.emplace_back("braking within a control period takes more than law.safety.distance_m: agents may touch");

  SafetyPrediction prediction;
  for (const std::string& reason : reasons)
    prediction.warnings.push_back("law.safety: no distance is promised: " + reason);
  if (!experiment.events.empty()) reasons.emplace_back("events change the run");
  if (found.touching.count > 0)
    prediction.warnings.push_back("law.safety.distance_m: it keeps centres apart; the bodies of " +
                                  found.touching.Text("can touch at this distance"));
  if (!reasons.empty())
    prediction.silent = fmt::format("{}", fmt::join(reasons, "; "));
  else if (experiment.size() > 1) {
    prediction.min_separation_m = kept_m;
    prediction.axes = experiment.agents.front().law.axes;
    Assume(experiment, prediction);
  }
  return prediction;
}

}  // namespace mascot
