// Laws that do not listen to neighbours: every agent flies to its target by itself, with two poles each.
#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/parts.h"

namespace mascot {

void PredictFlight(const Experiment& experiment, const LinearForm& form, Prediction& prediction) {
  prediction.of_agreement = false;
  const LinearAgent first = FlyingAgent(experiment.agents.front(), form);
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.traits().rolls)
      prediction.silent = "a unicycle turns before it goes where it is wanted";
    else if (agent.has_own_law || !FlyingAgent(agent, form).MovesAs(first))
      prediction.silent = "agents fly the waypoints in different ways";
  }
  if (experiment.sensors.own_delay_s > 0) prediction.silent = "sensors.own.delay_s: agents know late where they are";
  if (!prediction.silent.empty()) return;
  const LinearMode mode = first.Mode(1);
  prediction.stable = JudgeModes(experiment, {&mode, 1}, {"law.d_gain", 0, form.beta}, prediction);
  if (!*prediction.stable) return;
  prediction.slowest_rate_per_s = prediction.rate_per_s = DecayRate({&mode, 1}, experiment.period_s());
  prediction.settling_time_s = SettlingTime(mode, experiment.period_s());
}

}  // namespace mascot
