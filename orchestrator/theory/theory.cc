#include "orchestrator/theory/theory.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/agent.h"
#include "agent/laws/laws.h"
#include "agent/user_code/law_output.h"
#include "experiment/live_experiment.h"
#include "experiment/phase.h"
#include "orchestrator/team/exchange.h"
#include "orchestrator/team/ideal_team.h"
#include "orchestrator/theory/crowding.h"
#include "orchestrator/theory/flight_envelope.h"
#include "orchestrator/theory/free_flight.h"
#include "orchestrator/theory/law_figures.h"
#include "orchestrator/theory/links_on_average.h"
#include "orchestrator/theory/loop_agreement.h"
#include "orchestrator/theory/loop_bands.h"
#include "orchestrator/theory/obstacle_warnings.h"
#include "orchestrator/theory/parts.h"
#include "orchestrator/theory/short_phase.h"
#include "orchestrator/theory/stack_rate.h"
#include "orchestrator/theory/step_length.h"
#include "orchestrator/theory/turning.h"

namespace mascot {
namespace {

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
  const SuppressedLawOutput suppressed;
  Experiment prompt = experiment;
  prompt.links = {};  // delays and losses only postpone the tick at which agents hear all their neighbours
  const std::vector<Motion> motions = MotionsAtStart(experiment);
  Exchange exchange(prompt);  // without messages: none has been sent before
  std::vector<Sample> samples;
  for (const AgentConfig& agent : experiment.agents) {
    // One after the other: on a dense graph, all agents together take much memory.
    const Command command =
        Agent(prompt, agent.id)
            .Want(0, motions[static_cast<std::size_t>(agent.id - 1)], exchange.SamplesFor(agent.id, motions, samples));
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

/// Adds what the team's law itself has to say about the experiment.
void PredictFigures(const Experiment& experiment, Prediction& prediction) {
  const bool alone = std::ranges::none_of(experiment.agents, &AgentConfig::has_own_law);
  const bool goes_on = std::ranges::any_of(experiment.agents, [](const AgentConfig& a) { return a.law.since < 0; });
  LawTheory theory = goes_on ? LawTheory{.silent = "the law goes on with what it remembers of the phase before"}
                     : alone ? EntryOf(experiment.law).predict(experiment)
                             : LawTheory{.silent = "agents have laws of their own"};
  if (theory.silent.empty()) {
    const auto& first = prediction.first_speed ? prediction.first_speed : prediction.first_acceleration;
    const Freedom needed{.from_limits = theory.unlimited, .from_contacts = !theory.of_messages};
    if (std::string why = WhyNotFree(experiment, needed, first); !why.empty())
      theory = {.silent = std::move(why), .warnings = std::move(theory.warnings)};
  }
  Complete(experiment, EntryOf(experiment.law), theory.figures);
  prediction.law_figures = std::move(theory.figures);
  if (!theory.silent.empty()) (prediction.stable ? prediction.figures_silent : prediction.silent) = theory.silent;
  if (theory.value_m) prediction.value_m = theory.value_m;
  if (theory.holds_from) prediction.holds_from = theory.holds_from;
  if (theory.rates) JudgeTurning(experiment, *theory.rates, prediction);
  for (std::string& warning : theory.warnings) prediction.warnings.push_back(std::move(warning));
}

/// Predicts the behaviour under the law, from what its table row says: its linear or pursuit form, its own predictions.
void PredictLaw(const Experiment& experiment, Prediction& prediction) {
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
    prediction.silent = WhyUnknown(experiment.law);
    return;
  }
  if (!timeline) {
    prediction.silent = fmt::format(
        "graph.repeat_s: the schedule is not back at the same tick soon, or changes more than {} times", kMaxIntervals);
    return;
  }
  if (EntryOf(experiment.law).agrees)
    for (std::string& warning : PersistenceWarnings(experiment, *timeline, *prediction.persistence))
      prediction.warnings.push_back(std::move(warning));
  if (prediction.safety) {
    prediction.silent = "law.safety may change what the law asks for";
    return;
  }
  if (const auto loop = FindUnstableLoop(experiment)) {
    prediction.stable = false;
    prediction.silent = fmt::format("the {} loop of agent {} is unstable", loop->name, loop->agent);
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
  const double delivered = MinDeliveredUnheld(experiment);
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

/// Predicts a phase, as an experiment of its own. `silent`: why theory says nothing of it; empty: it may.
Prediction PredictPhase(const Experiment& phase, const std::string& silent, bool is_last) {
  Prediction prediction;
  prediction.on_average = LosesSome(phase) || !phase.sensors.own.IsNone() || !phase.sensors.heard.IsNone();
  prediction.silent = silent;
  prediction.safety = PredictSafety(phase);
  PredictFirstCommand(phase, prediction);
  if (silent.empty()) PredictLaw(phase, prediction);
  if (silent.empty()) JudgeAgreementOnLoops(phase, prediction);
  if (silent.empty()) PredictOnLoops(phase, prediction);
  WarnOfFirstCommands(phase, prediction);
  WarnOfSilence(phase, prediction);
  if (std::string warning = ShortPhaseWarning(phase, is_last, prediction); !warning.empty())
    prediction.warnings.push_back(std::move(warning));
  if (const auto loop = FindUnstableLoop(phase)) prediction.warnings.push_back(Warning(*loop, phase));
  for (std::string& warning : LiftWarnings(phase)) prediction.warnings.push_back(std::move(warning));
  for (std::string& warning : RotorFailureWarnings(phase)) prediction.warnings.push_back(std::move(warning));
  for (std::string& warning : CrowdingWarnings(phase)) prediction.warnings.push_back(std::move(warning));
  for (std::string& warning : ObstacleWarnings(phase)) prediction.warnings.push_back(std::move(warning));
  const auto& driven = prediction.first_speed;
  for (std::string& warning : StepLengthWarnings(phase, driven ? std::min(driven->asked, driven->limit) : 0))
    prediction.warnings.push_back(std::move(warning));
  if (prediction.safety)
    prediction.warnings.insert(prediction.warnings.end(), prediction.safety->warnings.begin(),
                               prediction.safety->warnings.end());
  return prediction;
}

/// Why events in the phase from tick `from` on keep theory silent; empty: they do not.
std::string SilencingEvent(const Experiment& experiment, std::int64_t from) {
  const std::int64_t end = EndOfPhase(experiment, from);
  const auto within = EventsWithin(experiment, from, end == experiment.ticks() ? end + 1 : end);
  const auto event = std::ranges::find_if(within, [](const Event& other) { return !other.law; });
  if (event == within.end()) return "";
  return SilentFrom(experiment, event->tick);
}

/// Why theory is silent about a later phase, which flies `now`; empty: it is not.
std::string WhySilentLater(const Experiment& start, const Experiment& now, std::int64_t from) {
  if (std::string event = SilencingEvent(start, from); !event.empty()) return event;
  if (!now.cut.empty()) return "events have cut edges of the graph";
  if (!now.schedule.IsConstant()) return "graph.schedule: theory knows schedules of the graph only from the start";
  return "";
}

/// Predicts the phases after the first, each from where ideal bodies are by then.
std::vector<LaterPhase> PredictLater(const Experiment& start) {
  const SuppressedLawOutput suppressed;
  const std::vector<std::int64_t> phases = PhasesOf(start);
  std::vector<LaterPhase> later;
  LiveExperiment live(start, &LawTable(), /*checked=*/true);
  IdealTeam team(start);
  std::string failure;
  auto event = start.events.begin();
  for (std::int64_t tick = 0; tick <= phases.back(); ++tick) {
    for (; event != start.events.end() && event->tick == tick; ++event) team.Adopt(live.After(*event));
    if (std::ranges::binary_search(phases, tick)) {
      const auto phase = std::make_shared<const Experiment>(
          PhaseAsExperiment(start, *live.now(), tick, EndOfPhase(start, tick), team.motions()));
      const std::string silent = failure.empty() ? WhySilentLater(start, *live.now(), tick) : failure;
      later.push_back({tick, phase, PredictPhase(*phase, silent, tick == phases.back())});
    }
    try {
      if (failure.empty()) team.Step();
    } catch (const std::exception& why) {
      failure = fmt::format("a law before it fails on ideal bodies: {}", why.what());
    }
  }
  return later;
}

/// What two phases promise together.
std::optional<SafetyPrediction> Weaker(const std::optional<SafetyPrediction>& a,
                                       const std::optional<SafetyPrediction>& b) {
  if (!a && !b) return std::nullopt;
  if (!a || !b) return SafetyPrediction{.silent = "law.safety is not on in all phases"};
  if (!a->min_separation_m || !b->min_separation_m) return a->min_separation_m ? b : a;
  return *a->min_separation_m <= *b->min_separation_m ? a : b;
}

void WarnOfLatePhases(const Experiment& experiment, Prediction& prediction) {
  for (const double at_s : experiment.late_phases_s)
    prediction.warnings.push_back(fmt::format(
        "law.schedule: the phase of {:g} s does not begin: the run ends at {:g} s", at_s, experiment.run.duration_s));
}

}  // namespace

std::string SilentFrom(const Experiment& experiment, std::int64_t tick) {
  return fmt::format("events change the run, from {:g} s on", experiment.time_s(tick));
}

Prediction Predict(const Experiment& experiment) {
  if (experiment.user_code == UserCode::kNeverRuns && FliesCodeOfUsers(experiment)) {
    Prediction none;
    none.silent = "agents fly a law of a user, whose code does not run when it is only looked at";
    return none;
  }
  const std::string silent = SilencingEvent(experiment, 0);
  if (PhasesOf(experiment).empty()) {
    Prediction prediction = PredictPhase(experiment, silent, /*is_last=*/true);
    WarnOfLatePhases(experiment, prediction);
    return prediction;
  }
  const Experiment first =
      PhaseAsExperiment(experiment, experiment, 0, EndOfPhase(experiment, 0), MotionsAtStart(experiment));
  Prediction prediction = PredictPhase(first, silent, /*is_last=*/false);
  prediction.later = PredictLater(experiment);
  for (const LaterPhase& phase : prediction.later)
    prediction.safety = Weaker(prediction.safety, phase.prediction.safety);
  for (const LaterPhase& phase : prediction.later)
    for (const std::string& warning : phase.prediction.warnings)
      if (std::ranges::find(prediction.warnings, warning) == prediction.warnings.end())
        prediction.warnings.push_back(fmt::format("{} (from {:g} s on)", warning, experiment.time_s(phase.from)));
  WarnOfLatePhases(experiment, prediction);
  return prediction;
}

}  // namespace mascot
