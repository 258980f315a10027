// What a platoon will do: Gamma of string_stability.h, and a flight ahead on double integrators, which shows whether
// its start is forgotten in time, whether limits cut, and how near vehicles come to each other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/platoon/platoon.h"
#include "agent/laws/platoon/string_ahead.h"
#include "agent/laws/platoon/string_stability.h"
#include "agent/laws/platoon/swing_meter.h"

namespace mascot {
namespace {

constexpr double kForgotten = 1e-4;  // of the growth of a swing, what the start may still change

/// The platoon as it flies on double integrators.
std::optional<StringAhead> FlyAhead(const Experiment& experiment, const PlatoonParams& params) {
  std::vector<std::unique_ptr<Law>> laws;
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents) {
    laws.push_back(std::make_unique<Platoon>(agent));
    ids.push_back(agent.id);
  }
  SwingMeter meter(experiment, ids, params.swing > 0 ? params.w : 0, params.forward);
  return FlyString(experiment, laws, meter);
}

/// Why the closed forms are not what a run will show; empty: they are.
std::string WhyNotAsFlown(const Experiment& experiment, const std::optional<StringAhead>& ahead) {
  if (!ahead) return "so many vehicles are not flown ahead for so many ticks, to see that the start is forgotten";
  if (ahead->is_cut) return "the limit of the acceleration cuts what the law asks for";
  const std::optional<double>& least_gap_m = ahead->figures[2].front();
  if (experiment.physics.collisions && least_gap_m && *least_gap_m < 2 * kBallRadius_m) return "vehicles collide";
  return "";
}

}  // namespace

LawTheory PredictPlatoon(const Experiment& experiment) {
  const auto& params = ParamsOf<PlatoonParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kAcceleration); !why.empty()) return {.silent = std::move(why)};
  for (const AgentConfig& agent : experiment.agents)
    if (agent.traits().has_airframe) return {.silent = "the closed form is of double integrators"};
  const StringStability string(params.following);
  if (!string.Decays()) return {.silent = "the loop of law.p_gain and law.d_gain does not decay"};
  const double largest = string.LargestGain(), gain = string.Gain(params.w);
  const std::optional<double> headway_s = string.MinHeadway_s();
  LawTheory theory;
  if (largest > 1)
    theory.warnings.push_back(fmt::format(
        "law.headway_s: the string is not stable: swings grow by up to {:.4g} from one vehicle to the next; {}",
        largest,
        headway_s ? fmt::format("a headway of {:.4g} s would do", *headway_s) : "no headway up to 100 s would do"));
  const auto ahead = FlyAhead(experiment, params);
  theory.silent = WhyNotAsFlown(experiment, ahead);
  if (!theory.silent.empty()) return theory;
  theory.figures = {{}, {{}, Bound::kAtMost}, {.values = ahead->figures[2]}, {{headway_s}}};
  const FigureValues& flown = ahead->figures.front();
  const bool forgets = std::ranges::all_of(
      flown, [&](const auto& one) { return one && std::abs(*one - gain) < kForgotten * std::max(1.0, gain); });
  if (flown.empty()) return {.silent = "nobody follows"};
  if (forgets) theory.figures[0].values.assign(flown.size(), gain);
  if (forgets || params.swing == 0) theory.figures[1].values = {largest};
  const char* const unsteady = "the run ends before the start has been forgotten for two periods of the swing";
  if (!forgets) theory.figures[0].why = params.swing == 0 ? "law.disturbance_m_per_s is 0: nothing swings" : unsteady;
  if (theory.figures[1].values.empty()) theory.figures[1].why = unsteady;
  if (!headway_s) theory.figures[3].why = "no headway up to 100 s is enough";
  if (!forgets && params.swing > 0)
    theory.warnings.emplace_back(
        "run.duration_s: the run ends before the start has been forgotten for two periods of the swing, so that its "
        "growth "
        "is not predicted");
  return theory;
}

std::unique_ptr<LawMeter> MakePlatoonMeter(const Experiment& experiment, std::span<const int> ids) {
  const auto& params = ParamsOf<PlatoonParams>(experiment.agent(ids.front()).law);
  return std::make_unique<SwingMeter>(experiment, ids, params.swing > 0 ? params.w : 0, params.forward);
}

}  // namespace mascot
