#include "orchestrator/theory/theory.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/laws.h"
#include "agent/python.h"
#include "orchestrator/team/team.h"
#include "orchestrator/theory/crowding.h"
#include "orchestrator/theory/flight_envelope.h"
#include "orchestrator/theory/links_on_average.h"
#include "orchestrator/theory/obstacle_warnings.h"
#include "orchestrator/theory/parts.h"

namespace mascot {
namespace {

/// Motions of all agents at tick 0.
std::vector<Motion> Start(const Experiment& experiment) {
  std::vector<Motion> motions(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) {
    Motion& motion = motions[static_cast<std::size_t>(agent.id - 1)];
    motion.p_WB = agent.p_W;
    motion.v_WB = agent.v_W;
  }
  return motions;
}

/// The largest component of an agent's first command: of the velocity (m/s), if the command is one, else of the
/// acceleration (m/s^2). Before limits; but an acceleration towards a velocity that its limit makes small enough is
/// what it is after that.
double Asked(const Command& command, bool velocity) {
  const bool cut = (command.flags & kAccelerationLimited) != 0;
  const Eigen::Vector3d& asked_W = velocity ? command.v_law_W : cut ? command.a_law_W : command.a_limited_W;
  return asked_W.cwiseAbs().maxCoeff();
}

/// Keeps the command that asks for more relative to its limit.
void Keep(std::optional<FirstCommand>& worst, const FirstCommand& first) {
  if (!worst || first.asked * worst->limit > worst->asked * first.limit) worst = first;
}

void PredictFirstCommand(const Experiment& experiment, Prediction& prediction) {
  const SuppressedPythonOutput suppressed;
  Experiment prompt = experiment;
  prompt.links = {};  // delays and losses only postpone the tick at which agents hear all their neighbours
  Team team(prompt);
  const std::vector<Motion> motions = Start(experiment);
  for (const AgentConfig& agent : experiment.agents) {
    const Command command = team.Want(agent.id, 0, motions);
    const bool velocity = IsCommandedByVelocity(agent);
    const double asked = Asked(command, velocity);
    const double limit = velocity ? agent.control.max_speed_m_per_s : agent.control.max_acceleration_m_per_s2;
    Keep(velocity ? prediction.first_speed : prediction.first_acceleration, {agent.id, asked, limit});
    if (!agent.traits().has_airframe) continue;
    const double sideways = command.a_limited_W.head<2>().cwiseAbs().maxCoeff();
    Keep(prediction.first_lean, {agent.id, sideways, LeanLimit(agent, experiment.physics.gravity_m_per_s2)});
  }
}

void WarnOfFirstCommand(const std::optional<FirstCommand>& first, std::string_view key, std::string_view unit,
                        Prediction& prediction) {
  if (!first || first->asked <= first->limit) return;
  prediction.warnings.push_back(
      fmt::format("{}: the first command would already saturate: agent {} asks for {:.4g} {}, the limit is {:.4g}", key,
                  first->agent, first->asked, unit, first->limit));
}

void WarnOfFirstCommands(const Experiment& experiment, Prediction& prediction) {
  if (EntryOf(experiment.law).pursuit == nullptr)  // for pursuit laws, WarnOfCutBeta has warned
    WarnOfFirstCommand(prediction.first_acceleration, "control.max_acceleration_m_per_s2", "m/s^2", prediction);
  WarnOfFirstCommand(prediction.first_speed, "control.max_speed_m_per_s", "m/s", prediction);
  if (const auto& first = prediction.first_lean; first && first->asked > first->limit)
    prediction.warnings.push_back(fmt::format(
        "agents.airframe: the first command is more than leaning by tilt_limit_rad gives: agent {} is to accelerate "
        "sideways by {:.4g} m/s^2, and can by {:.4g}",
        first->agent, first->asked, first->limit));
}

void WarnOfShortRun(const Experiment& experiment, Prediction& prediction) {
  for (const auto& time_s : {prediction.settling_time_s, prediction.minmax_time_s})
    if (time_s && *time_s > experiment.run.duration_s)
      prediction.warnings.push_back(
          fmt::format("run.duration_s: the run ends after {:.4g} s, before what theory expects at {:.4g} s",
                      experiment.run.duration_s, *time_s));
}

/// Adds what the team's law itself has to say about the experiment.
void PredictFigures(const Experiment& experiment, Prediction& prediction) {
  const bool alone = std::ranges::none_of(experiment.agents, &AgentConfig::has_own_law);
  LawTheory theory =
      alone ? EntryOf(experiment.law).predict(experiment) : LawTheory{.silent = "agents have laws of their own"};
  prediction.law_figures = std::move(theory.figures);
  if (!theory.silent.empty()) (prediction.stable ? prediction.figures_silent : prediction.silent) = theory.silent;
  if (theory.value_m) prediction.value_m = theory.value_m;
  for (std::string& warning : theory.warnings) prediction.warnings.push_back(std::move(warning));
}

/// Predicts the behaviour under the law, from what its table row says: its linear or pursuit form, its own predictions.
void PredictLaw(const Experiment& experiment, Prediction& prediction) {
  if (!experiment.events.empty()) {
    prediction.silent =
        fmt::format("events change the run, from {:g} s on", experiment.time_s(experiment.events.front().tick));
    return;
  }
  const std::optional<Timeline> timeline = TimelineOf(experiment);
  if (timeline) prediction.persistence = PersistenceOf(experiment, *timeline);
  const std::optional<LinearForm> linear = LinearFormOf(experiment.law);
  const std::optional<PursuitForm> pursuit = PursuitFormOf(experiment.law);
  const bool predicts = EntryOf(experiment.law).predict != nullptr;
  const auto liar =
      std::ranges::find_if(experiment.agents, [](const AgentConfig& agent) { return agent.lie.has_value(); });
  const bool lies = liar != experiment.agents.end();
  if (lies && !predicts) {
    prediction.silent = fmt::format("agent {} lies", liar->id);
    return;
  }
  if (!linear && !pursuit && !predicts) {
    prediction.silent = "theory does not know the law " + experiment.law.name;
    return;
  }
  if (!timeline) {
    prediction.silent =
        fmt::format("graph.repeat_s: the schedule is not back at the same tick soon, or changes more than {} times",
                    kMostIntervals);
    return;
  }
  if (EntryOf(experiment.law).agrees)
    for (std::string& warning : PersistenceWarnings(experiment, *timeline, *prediction.persistence))
      prediction.warnings.push_back(std::move(warning));
  if (prediction.safety) {
    prediction.silent = "law.safety may change what the law asks for";
    return;
  }
  if (pursuit && !lies)
    PredictPursuit(experiment, *timeline, *pursuit, prediction);
  else if (linear && linear->listens && !lies)
    PredictLinear(experiment, *timeline, prediction);
  else if (linear && !linear->listens)
    PredictFlight(experiment, *linear, prediction);
  if (predicts) PredictFigures(experiment, prediction);
}

/// Warns of links on which a lost sample is silence for a tick, with what that costs.
void WarnOfSilence(const Experiment& experiment, Prediction& prediction) {
  const double delivered = LeastDeliveredUnheld(experiment);
  if (delivered == 1) return;
  std::string cost = fmt::format("what is heard counts for {:.3g} of its weight", delivered);
  if (prediction.slowest_rate_per_s && LongestDelayTicks(experiment) == 0) {
    Experiment lossless = experiment;
    lossless.links = {};
    Prediction without;
    PredictLaw(lossless, without);
    if (without.slowest_rate_per_s)
      cost += fmt::format(", and the slowest mode decays at {:.4g} instead of {:.4g} 1/s",
                          *prediction.slowest_rate_per_s, *without.slowest_rate_per_s);
  }
  prediction.warnings.push_back(
      fmt::format("link.hold_s: below one control period, {:.4g} s, it lets a lost sample be silence for that tick: on "
                  "average {}; a longer one keeps the last sample instead",
                  experiment.period_s(), cost));
}

}  // namespace

Prediction Predict(const Experiment& experiment) {
  Prediction prediction;
  prediction.on_average =
      LosesSome(experiment) || !experiment.sensors.own.IsNone() || !experiment.sensors.heard.IsNone();
  prediction.safety = PredictSafety(experiment);
  PredictLaw(experiment, prediction);
  PredictFirstCommand(experiment, prediction);
  WarnOfFirstCommands(experiment, prediction);
  WarnOfSilence(experiment, prediction);
  WarnOfShortRun(experiment, prediction);
  for (std::string& warning : LiftWarnings(experiment)) prediction.warnings.push_back(std::move(warning));
  for (std::string& warning : CrowdingWarnings(experiment)) prediction.warnings.push_back(std::move(warning));
  for (std::string& warning : ObstacleWarnings(experiment)) prediction.warnings.push_back(std::move(warning));
  if (prediction.safety)
    prediction.warnings.insert(prediction.warnings.end(), prediction.safety->warnings.begin(),
                               prediction.safety->warnings.end());
  return prediction;
}

}  // namespace mascot
