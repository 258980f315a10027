#include "orchestrator/theory/free_flight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "orchestrator/team/ideal_team.h"
#include "orchestrator/theory/contact_watch.h"

namespace mascot {
namespace {

constexpr double kFarBelow = 0.1;  // of the limit
constexpr double kReach_m = 0.01;  // of contacts

/// Why a limit has cut a command of this tick; empty: none has.
std::string WhatIsCut(const Experiment& experiment, std::span<const Command> commands, std::int64_t tick) {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const bool of_speed = (commands[i].flags & kSpeedLimited) != 0;
    if (of_speed || (commands[i].flags & kAccelerationLimited) != 0)
      return fmt::format("the limit of the {} cuts what the law asks for: of agent {} at {:g} s",
                         of_speed ? "speed" : "acceleration", i + 1, experiment.time_s(tick));
  }
  return "";
}

/// Whether bodies stay at heights at which they have nothing to touch.
bool IsLayered(const Experiment& experiment) {
  if (experiment.law.axes == Axes::kXyz || (experiment.physics.collisions && !experiment.physics.obstacles.empty()))
    return false;
  for (const AgentConfig& a : experiment.agents) {
    const double half_m = a.size_m().z() / 2;
    if (a.v_W.z() != 0 || (experiment.physics.ground && a.p_W.z() < half_m + kReach_m)) return false;
    for (const AgentConfig& b : experiment.agents)
      if (a.id < b.id && std::abs(a.p_W.z() - b.p_W.z()) < half_m + b.size_m().z() / 2 + kReach_m) return false;
  }
  return true;
}

bool MayTouchAnything(const Experiment& experiment) {
  return (experiment.physics.collisions || experiment.physics.ground) && !IsLayered(experiment);
}

}  // namespace

std::string WhyNotFree(const Experiment& experiment, const Freedom& needed, const std::optional<FirstCommand>& first) {
  const bool touches = needed.from_contacts && MayTouchAnything(experiment);
  if (!needed.from_limits && !touches) return "";
  const auto agents = static_cast<double>(experiment.size());
  const double each_tick = static_cast<double>(experiment.graph.edges()) + agents + (touches ? agents * agents / 2 : 0);
  if (each_tick * static_cast<double>(experiment.ticks()) > kMaxFreeSteps) {
    if (!needed.from_limits || (first && first->asked > 0 && first->asked < kFarBelow * first->limit)) return "";
    return "so many agents are not flown ahead for so many ticks, to see whether a limit cuts what the law asks for";
  }
  IdealTeam team(experiment);
  ContactWatch watch(experiment, kReach_m);
  try {
    for (std::int64_t tick = 0; tick < experiment.ticks(); ++tick) {
      if (std::string near = touches ? watch.WhatMayTouch(team.motions()) : ""; !near.empty())
        return fmt::format("{}, {:.3g} s from the start", near, experiment.time_s(tick));
      team.Step();
      if (!needed.from_limits) continue;
      if (std::string cut = WhatIsCut(experiment, team.commands(), tick); !cut.empty()) return cut;
    }
  } catch (const std::exception& why) {
    return fmt::format("a law fails on ideal bodies: {}", why.what());
  }
  return "";
}

}  // namespace mascot
