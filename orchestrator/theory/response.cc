#include "orchestrator/theory/response.h"

#include <algorithm>
#include <exception>

#include "agent/laws/laws.h"
#include "agent/user_code/law_output.h"
#include "experiment/experiment.h"
#include "experiment/phase.h"
#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/team/ideal_team.h"
#include "orchestrator/theory/theory.h"

namespace mascot {
namespace {

/// Whether a flight of ideal bodies says how the agents of a phase come to agree: by laws that make them agree, which
/// begin with the phase, and are no code of users.
bool IdealBodiesAgree(const Experiment& phase) {
  const double steps = static_cast<double>(phase.ticks()) * (phase.size() + static_cast<double>(phase.graph.edges()));
  return steps <= kMaxIdealSteps && !FliesCodeOfUsers(phase) &&
         std::ranges::all_of(LawsIn(phase), [](const LawEntry* law) { return law->agrees; }) &&
         std::ranges::all_of(phase.agents, [](const AgentConfig& agent) { return agent.law.since >= 0; });
}

/// The response of ideal bodies; nothing: a law fails.
std::optional<Response> FlyIdealBodies(const Experiment& phase) try {
  IdealTeam team(phase);
  ResponseRecorder response;
  for (std::int64_t tick = 0; tick < phase.ticks(); ++tick) {
    response.Add(DisagreementOf(phase, team.motions()));
    team.Step();
  }
  response.Add(DisagreementOf(phase, team.motions()));
  return response.Take();
} catch (const std::exception&) {
  return std::nullopt;
}

/// The response of a phase that begins at `from`, as an experiment of its own.
std::optional<PartResponse> ResponseOf(std::int64_t from, const Experiment& phase, const Prediction& prediction) {
  PartResponse part{.from = from, .until = from + phase.ticks()};
  const auto event = std::ranges::find_if(phase.events, [](const Event& other) { return !other.law; });
  if (event != phase.events.end()) {  // it keeps theory silent
    if (event->tick == 0) return std::nullopt;
    const Experiment before = PhaseAsExperiment(phase, phase, 0, event->tick, MotionsAtStart(phase));
    return ResponseOf(from, before, Predict(before));
  }
  if (prediction.response) {
    part.response = *prediction.response;
    return part;
  }
  if (prediction.stable == false || !IdealBodiesAgree(phase)) return std::nullopt;
  std::optional<Response> flown = FlyIdealBodies(phase);
  if (!flown) return std::nullopt;
  part.of_ideal_bodies = true;
  part.response = *std::move(flown);
  return part;
}

}  // namespace

void ResponseRecorder::Add(double disagreement_m) {
  auto& values = response_.value_m;
  if (ticks_++ % response_.every != 0) return;
  if (values.size() == Response::kMaxPoints) {
    for (std::size_t k = 0; 2 * k < values.size(); ++k) values[k] = values[2 * k];
    values.resize(values.size() / 2);
    response_.every *= 2;
  }
  values.push_back(disagreement_m);
}

std::vector<PartResponse> ResponsesOf(const Experiment& experiment, const Prediction& prediction) {
  if (experiment.user_code == UserCode::kNeverRuns && FliesCodeOfUsers(experiment)) return {};
  const SuppressedLawOutput suppressed;
  std::vector<PartResponse> responses;
  const auto add = [&](std::optional<PartResponse> part) {
    if (part) responses.push_back(*std::move(part));
  };
  const std::int64_t first_ends = EndOfPhase(experiment, 0);
  add(ResponseOf(0, PhaseAsExperiment(experiment, experiment, 0, first_ends, MotionsAtStart(experiment)), prediction));
  for (const LaterPhase& later : prediction.later) add(ResponseOf(later.from, *later.experiment, later.prediction));
  return responses;
}

}  // namespace mascot
