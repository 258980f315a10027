#include "orchestrator/theory/loop_team.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>

#include "agent/laws/laws.h"
#include "agent/user_code/law_output.h"
#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/team/team.h"
#include "orchestrator/theory/contact_watch.h"

namespace mascot {
namespace {

constexpr double kSteepest_rad = 0.6;  // beyond, roll and pitch are not two loops by themselves
// Share of all commands, with more of which both tilts at once are not two loops; in a longer run, of the commands of
// so many seconds: a team that rests for long has been cut no less.
constexpr double kMaxTiltsCut = 0.02, kLongestCounted_s = 20;
constexpr double kMargin_m = 0.1;  // of bodies to what they might touch
constexpr double kFarthest_m = 1e5;

class LoopTeam {
 public:
  LoopTeam(const Experiment& experiment, const LoopError& error)
      : experiment_(experiment),
        team_(experiment),
        bodies_(experiment, error),
        commands_(experiment.agents.size()),
        messages_(commands_.size()),
        agreed_W_(commands_.size()),
        watch_(experiment, kMargin_m) {}

  /// The motions of this tick, and the commands and messages that answer them. Throws what a law throws.
  TeamRow Decide() {
    team_.Want(tick_, bodies_.motions(), commands_);
    for (const AgentConfig& agent : experiment_.agents) {
      const std::span<const double> message = team_.message(agent.id);
      messages_[static_cast<std::size_t>(agent.id - 1)].assign(message.begin(), message.end());
    }
    return {.tick = tick_, .motions = bodies_.motions(), .commands = commands_, .messages = messages_};
  }

  void Move() {
    bodies_.Step(commands_);
    tilts_cut_ += bodies_.tilts_cut();
    ++tick_;
  }

  /// Why the bodies are not where the model has them; empty: they are.
  std::string Astray() const {
    for (std::size_t i = 0; i < commands_.size(); ++i) {
      if (!(bodies_.motions()[i].p_WB.cwiseAbs().maxCoeff() < kFarthest_m)) return Agent(i) + " is carried off";
      if (bodies_.tilt_rad(i) > kSteepest_rad) return Agent(i) + " tilts by more than 0.6 rad";
    }
    return "";
  }

  /// What might touch what; empty: nothing.
  std::string MayTouch() { return watch_.WhatMayTouch(bodies_.motions()); }

  /// What agents agree on: their positions, less their places in a formation.
  const std::vector<Eigen::Vector3d>& WithoutPlaces() {
    const std::span<const Eigen::Vector3d> places_W = PlacesOf(experiment_.law);
    for (std::size_t i = 0; i < agreed_W_.size(); ++i) {
      agreed_W_[i] = bodies_.motions()[i].p_WB;
      if (i < places_W.size()) agreed_W_[i] -= places_W[i];
    }
    return agreed_W_;
  }

  /// Why the limits were reached too often for the model; empty: they were not.
  std::string Cut() const {
    const double ticks = std::min(static_cast<double>(tick_), kLongestCounted_s * experiment_.control.rate_hz);
    const double commands = ticks * static_cast<double>(commands_.size());
    return static_cast<double>(tilts_cut_) > kMaxTiltsCut * commands
               ? "the limit of the tilt cuts more than 2 % of what quadrotors are commanded"
               : "";
  }

  bool is_tilt_cut() const { return tilts_cut_ > 0; }
  std::int64_t tick() const { return tick_; }

 private:
  static std::string Agent(std::size_t i) { return fmt::format("agent {}", i + 1); }

  const Experiment& experiment_;
  Team team_;
  LowLevelLoops bodies_;
  std::vector<Command> commands_;
  std::vector<std::vector<double>> messages_;
  std::vector<Eigen::Vector3d> agreed_W_;  // scratch
  ContactWatch watch_;
  std::int64_t tick_ = 0, tilts_cut_ = 0;
};

}  // namespace

LoopFlight FlyLoops(const Experiment& experiment, const LoopError& error) {
  const SuppressedLawOutput suppressed;
  const LawEntry& law = EntryOf(experiment.law);
  const std::vector<int> ids = AgentsWith(law, experiment);
  const std::unique_ptr<LawMeter> meter = law.meter == nullptr ? nullptr : law.meter(experiment, ids);
  AgreementMeter agreement(experiment);
  ResponseRecorder response;
  LoopFlight flight;
  LoopTeam team(experiment, error);
  try {
    for (;;) {
      std::string why = team.Astray();
      if (why.empty()) why = team.MayTouch();
      if (!why.empty())
        return {.silent = fmt::format("{}, {:.3g} s from the start", why, experiment.time_s(team.tick()))};
      const TeamRow row = team.Decide();
      if (meter) meter->Add(row);
      agreement.Add(team.WithoutPlaces());
      response.Add(agreement.disagreement_m());
      if (team.tick() == 0) flight.agreement.first_m = agreement.disagreement_m();
      if (team.tick() == experiment.ticks()) break;
      team.Move();
    }
    if (std::string why = team.Cut(); !why.empty()) return {.silent = std::move(why)};
  } catch (const std::exception& failure) {
    return {.silent = fmt::format("a law fails: {}", failure.what())};
  }
  if (meter) flight.figures = meter->Figures();
  flight.is_tilt_cut = team.is_tilt_cut();
  flight.agreement.settling_time_s = agreement.settling_time_s();
  flight.agreement.rate_per_s = agreement.rate_per_s();
  flight.agreement.mean_W = agreement.mean_W();
  flight.agreement.last_m = agreement.disagreement_m();
  flight.agreement.response = response.Take();
  return flight;
}

double WorkOfLoops(const Experiment& experiment) {
  double heard = experiment.size();
  for (const AgentConfig& agent : experiment.agents)
    heard += static_cast<double>(experiment.graph.HeardBy(agent.id).size());
  return heard * static_cast<double>(experiment.ticks() + 1);
}

}  // namespace mascot
