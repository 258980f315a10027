// Waypoint flight: every agent by itself, two poles each.
#include "agent/laws/waypoint.h"

#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/parts.h"

namespace mascot {

void PredictWaypoint(Experiment& experiment, const Timeline& /*timeline*/, Prediction& prediction) {
  prediction.of_agreement = false;
  LawConfig law = experiment.law;
  const WaypointParams params = ReadWaypoints(law.section, "");
  const LinearAgent first = WaypointAgent(experiment.agents.front(), params.p_gain, params.d_gain);
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.model == "unicycle")
      prediction.silent = "a unicycle turns before it goes where it is wanted";
    else if (agent.has_own_law || !WaypointAgent(agent, params.p_gain, params.d_gain).MovesAs(first))
      prediction.silent = "agents fly the waypoints in different ways";
  }
  if (experiment.sensors.own_delay_s > 0) prediction.silent = "sensors.own.delay_s: agents know late where they are";
  if (!prediction.silent.empty()) return;
  const LinearMode mode = first.Mode(1);
  prediction.stable = JudgeModes(experiment, {&mode, 1}, {"law.d_gain", 0, params.d_gain}, prediction);
  if (!*prediction.stable) return;
  prediction.rate_per_s = DecayRate({&mode, 1}, experiment.period_s());
  prediction.settling_time_s = SettlingTime(mode, experiment.period_s());
}

}  // namespace mascot
