#include "orchestrator/theory/loop_team.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>

#include "agent/laws.h"
#include "agent/python.h"
#include "experiment/obstacles.h"
#include "orchestrator/team/team.h"

namespace mascot {
namespace {

constexpr double kSteepest_rad = 0.6;   // beyond, roll and pitch are not two loops by themselves
constexpr double kMostTiltsCut = 0.02;  // share of all commands: with more, both tilts at once are not two loops
constexpr double kMargin_m = 0.1;       // of bodies to what they might touch
constexpr double kFarthest_m = 1e5;

/// Half of the lengths of the box around a body, however it is tilted, along the axes of W (m).
Eigen::Vector3d HalfBox_W(const AgentConfig& agent, const Motion& motion) {
  return motion.q_WB.toRotationMatrix().cwiseAbs() * agent.size_m() / 2;
}

class LoopTeam {
 public:
  LoopTeam(const Experiment& experiment, const LoopError& error)
      : experiment_(experiment), team_(experiment), commands_(experiment.agents.size()), messages_(commands_.size()) {
    bodies_.reserve(experiment.agents.size());
    for (const AgentConfig& agent : experiment.agents) bodies_.emplace_back(experiment, agent, error);
    for (const LowLevelLoop& body : bodies_) motions_.push_back(body.motion());
  }

  /// The motions of this tick, and the commands and messages that answer them. Throws what a law throws.
  TeamRow Decide() {
    for (const AgentConfig& agent : experiment_.agents) {
      const auto i = static_cast<std::size_t>(agent.id - 1);
      commands_[i] = team_.Want(agent.id, tick_, motions_);
      const std::span<const double> message = team_.message(agent.id);
      messages_[i].assign(message.begin(), message.end());
    }
    team_.EndTick();
    return {.tick = tick_, .motions = motions_, .commands = commands_, .messages = messages_};
  }

  void Move() {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i].Step(commands_[i]);
      tilts_cut_ += bodies_[i].is_tilt_cut() ? 1 : 0;
      motions_[i] = bodies_[i].motion();
    }
    ++tick_;
  }

  /// Why the bodies are not where the model has them; empty: they are.
  std::string Astray() const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!(motions_[i].p_WB.cwiseAbs().maxCoeff() < kFarthest_m)) return Agent(i) + " is carried off";
      if (bodies_[i].tilt_rad() > kSteepest_rad) return Agent(i) + " tilts by more than 0.6 rad";
    }
    return "";
  }

  /// What might touch what; empty: nothing.
  std::string MayTouch() {
    halves_W_.clear();
    for (const AgentConfig& agent : experiment_.agents)
      halves_W_.push_back(HalfBox_W(agent, motions_[static_cast<std::size_t>(agent.id - 1)]));
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (experiment_.physics.ground && motions_[i].p_WB.z() - halves_W_[i].z() < kMargin_m / 4)
        return Agent(i) + " may touch the ground";
      if (!experiment_.physics.collisions) continue;
      for (std::size_t j = 0; j < i; ++j)
        if (((motions_[i].p_WB - motions_[j].p_WB).cwiseAbs().array() <
             (halves_W_[i] + halves_W_[j]).array() + kMargin_m)
                .all())
          return fmt::format("agents {} and {} may touch", j + 1, i + 1);
      for (const Obstacle& obstacle : experiment_.physics.obstacles) {
        const Eigen::Vector3d away_W = NearestPoint_W(obstacle, motions_[i].p_WB) - motions_[i].p_WB;
        if (away_W.norm() < experiment_.agents[i].radius_m() + kMargin_m) return Agent(i) + " may touch an obstacle";
      }
    }
    return "";
  }

  /// Why the limits were reached too often for the model; empty: they were not.
  std::string Cut() const {
    const double commands = static_cast<double>(tick_) * static_cast<double>(bodies_.size());
    return static_cast<double>(tilts_cut_) > kMostTiltsCut * commands
               ? "the limit of the tilt cuts more than 2 % of what quadrotors are commanded"
               : "";
  }

  std::int64_t tick() const { return tick_; }

 private:
  static std::string Agent(std::size_t i) { return fmt::format("agent {}", i + 1); }

  const Experiment& experiment_;
  Team team_;
  std::vector<LowLevelLoop> bodies_;
  std::vector<Motion> motions_;
  std::vector<Command> commands_;
  std::vector<std::vector<double>> messages_;
  std::vector<Eigen::Vector3d> halves_W_;
  std::int64_t tick_ = 0, tilts_cut_ = 0;
};

}  // namespace

LoopFlight FlyLoops(const Experiment& experiment, const LoopError& error) {
  const SuppressedPythonOutput suppressed;
  const LawEntry& law = EntryOf(experiment.law);
  const std::vector<int> ids = AgentsWith(law, experiment);
  const std::unique_ptr<LawMeter> meter = law.meter(experiment, ids);
  LoopTeam team(experiment, error);
  try {
    for (;;) {
      std::string why = team.Astray();
      if (why.empty()) why = team.MayTouch();
      if (!why.empty()) return {fmt::format("{}, {:.3g} s from the start", why, experiment.time_s(team.tick())), {}};
      meter->Add(team.Decide());
      if (team.tick() == experiment.ticks()) break;
      team.Move();
    }
    if (std::string why = team.Cut(); !why.empty()) return {std::move(why), {}};
    return {"", meter->Figures()};
  } catch (const std::exception& failure) {
    return {fmt::format("a law fails: {}", failure.what()), {}};
  }
}

double WorkOfLoops(const Experiment& experiment) {
  double heard = experiment.size();
  for (const AgentConfig& agent : experiment.agents)
    heard += static_cast<double>(experiment.graph.HeardBy(agent.id).size());
  return heard * static_cast<double>(experiment.ticks() + 1);
}

}  // namespace mascot
