#include "agent/laws/parts/fly_ahead.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "agent/laws/parts/rigidity.h"
#include "base/random.h"

namespace mascot {
namespace {

constexpr double kMaxFlownSteps = 5e6, kDisturbance = 1e-9, kMaxGrowth = 1e4, kFarAway_m = 1e9;
constexpr double kLongerRun = 10;  // at most so many times as long

using Points = std::vector<Eigen::Vector3d>;

double LargestNorm(const Points& vectors) {
  double largest = 0;
  for (const Eigen::Vector3d& vector : vectors)
    largest = vector.allFinite() ? std::max(largest, vector.norm()) : INFINITY;
  return largest;
}

double LargestDifference(const Points& a, const Points& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

bool LimitCuts(const Experiment& experiment, const Points& v_W) {
  for (const AgentConfig& agent : experiment.agents)
    if (v_W[static_cast<std::size_t>(agent.id - 1)].cwiseAbs().maxCoeff() > agent.control.max_speed_m_per_s)
      return true;
  return false;
}

/// Whether the bodies of two agents, boxes that do not turn, are closer than contacts reach.
bool BodiesTouch(const Experiment& experiment, const Points& p_W) {
  constexpr double kReach_m = 0.01;
  for (std::size_t i = 0; i < p_W.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d sizes_m = experiment.agents[i].size_m() + experiment.agents[j].size_m();
      if (((p_W[i] - p_W[j]).cwiseAbs().array() < sizes_m.array() / 2 + kReach_m).all()) return true;
    }
  return false;
}

void Move(Points& p_W, const Points& v_W, double period_s) {
  for (std::size_t i = 0; i < p_W.size(); ++i) p_W[i] += period_s * v_W[i];
}

/// Flies on a team that does not have the shape at the end of the run, up to tick `last`, until it has kept it for a
/// fifth of its time. An agent slower than `rest_m_per_s` rests.
void FlyOn(const Experiment& experiment, const ShapeLaw& law, double rest_m_per_s, std::int64_t last,
           FlownAhead& ahead) {
  SettlingMeter settling(law.settled);
  Points p_W = ahead.p_W, v_W = law.velocities_W(p_W);
  for (std::int64_t tick = experiment.ticks() + 1; tick <= last && LargestNorm(v_W) > rest_m_per_s; ++tick) {
    if (LimitCuts(experiment, v_W) || (experiment.physics.collisions && BodiesTouch(experiment, p_W))) return;
    Move(p_W, v_W, experiment.period_s());
    settling.Add(tick, law.error(p_W));
    if (settling.from() && 5 * tick >= 6 * *settling.from()) break;
    v_W = law.velocities_W(p_W);
  }
  if (settling.from())
    ahead.later_s = experiment.time_s(*settling.from());
  else if (LargestNorm(v_W) <= rest_m_per_s)
    ahead.rest_W = std::move(p_W);
}

}  // namespace

FlownAhead FlyAhead(const Experiment& experiment, const ShapeLaw& law) {
  const double pairs = static_cast<double>(experiment.size()) * static_cast<double>(experiment.size());
  const double looks = static_cast<double>(experiment.graph.edges()) + (experiment.physics.collisions ? pairs / 2 : 0);
  if (looks * static_cast<double>(experiment.ticks()) > kMaxFlownSteps)
    return {.silent = "so many agents are not flown ahead for so many ticks"};
  const double h_s = experiment.period_s();
  FlownAhead ahead{.p_W = StartsOf(experiment)};
  const double disturbance_m = kDisturbance * ScaleOf(ahead.p_W, experiment.law.axes);
  Points beside_W = ahead.p_W;
  Random random(1, Random::Stream::kPositions);
  for (Eigen::Vector3d& p : beside_W) {
    const double x = random.In(-1, 1), y = random.In(-1, 1), z = random.In(-1, 1);
    p += disturbance_m * Along(experiment.law.axes, {x, y, z});
  }
  Points v_W = law.velocities_W(ahead.p_W);
  const double first_m_per_s = LargestNorm(v_W), beside_m_per_s = LargestNorm(law.velocities_W(beside_W));
  ahead.rests_at_start = beside_m_per_s > 0 && first_m_per_s < 1e-3 * beside_m_per_s;
  SettlingMeter settling(law.settled);
  settling.Add(0, law.error(ahead.p_W));
  for (std::int64_t tick = 1; tick <= experiment.ticks(); ++tick) {
    if (LimitCuts(experiment, v_W)) {
      ahead.silent = "a limit cuts the speeds that the law asks for";
      return ahead;
    }
    if (experiment.physics.collisions && BodiesTouch(experiment, ahead.p_W)) {
      ahead.silent = "bodies touch on the way";
      return ahead;
    }
    Move(ahead.p_W, v_W, h_s);
    Move(beside_W, law.velocities_W(beside_W), h_s);
    if (!(LargestNorm(ahead.p_W) < kFarAway_m)) {
      ahead.silent = "the start is too far from the shape for the control period";
      return ahead;
    }
    v_W = law.velocities_W(ahead.p_W);
    settling.Add(tick, law.error(ahead.p_W));
  }
  if (!(LargestDifference(ahead.p_W, beside_W) <= kMaxGrowth * disturbance_m))
    ahead.silent = "the least disturbance decides where the team goes from this start";
  ahead.error = law.error(ahead.p_W);
  if (settling.from()) ahead.settled_s = experiment.time_s(*settling.from());
  if (!ahead.silent.empty() || ahead.settled_s) return ahead;
  const double last =
      std::min(kMaxFlownSteps / std::max(1.0, looks), kLongerRun * static_cast<double>(experiment.ticks()));
  constexpr double kRest = 1e-6;  // of the first speed
  FlyOn(experiment, law, kRest * first_m_per_s, static_cast<std::int64_t>(last), ahead);
  return ahead;
}

std::optional<HoldsFrom> WhenShaped(const Experiment& experiment, const FlownAhead& ahead, std::string still_off) {
  if (!ahead.silent.empty()) return std::nullopt;
  if (ahead.settled_s) return HoldsFrom{.time_s = *ahead.settled_s};
  if (!ahead.rest_W.empty()) return std::nullopt;  // it never has it
  if (ahead.later_s) return HoldsFrom{.time_s = *ahead.later_s, .until_then = std::move(still_off)};
  return HoldsFrom{.time_s = experiment.run.duration_s, .bound = Bound::kAtLeast, .until_then = std::move(still_off)};
}

}  // namespace mascot
