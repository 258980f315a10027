#include "orchestrator/theory.h"

#include <spdlog/fmt/fmt.h>

#include "agent/laws.h"
#include "agent/python.h"
#include "orchestrator/crowding.h"
#include "orchestrator/team.h"
#include "orchestrator/theory_parts.h"

namespace mascot {
namespace {

/// Everybody at tick 0.
std::vector<Motion> Start(const Experiment& experiment) {
  std::vector<Motion> motions(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) {
    Motion& motion = motions[static_cast<std::size_t>(agent.id - 1)];
    motion.p_WB = agent.p_W;
    motion.v_WB = agent.v_W;
  }
  return motions;
}

void PredictFirstCommand(Experiment& experiment, Prediction& prediction) {
  const MutedPython muted;
  Team team(experiment);
  const std::vector<Motion> motions = Start(experiment);
  const AgentConfig* of = nullptr;
  for (const AgentConfig& agent : experiment.agents) {
    if (DrivenBy(agent.model) == Wanted::kVelocity) continue;  // has no acceleration to limit
    const Eigen::Vector3d a_W = team.Want(agent.id, 0, motions).a_law_W;
    const double asked = a_W.cwiseAbs().maxCoeff();
    if (asked <= prediction.first_command_m_per_s2.value_or(-1)) continue;
    prediction.first_command_m_per_s2 = asked;
    of = &agent;
  }
  if (of == nullptr) return;
  const double limit = of->control.max_acceleration_m_per_s2;
  prediction.first_command_limit_m_per_s2 = limit;
  if (*prediction.first_command_m_per_s2 <= limit || experiment.law.name == "minmax") return;  // WarnOfCutBeta has said so
  prediction.warnings.push_back(fmt::format(
      "control.max_acceleration_m_per_s2: the first command would already saturate: agent {} asks for {:.4g} m/s^2, "
      "the limit is {:.4g}",
      of->id, *prediction.first_command_m_per_s2, limit));
}

void WarnOfShortRun(const Experiment& experiment, Prediction& prediction) {
  for (const auto& time_s : {prediction.settling_time_s, prediction.minmax_time_s})
    if (time_s && *time_s > experiment.run.duration_s)
      prediction.warnings.push_back(fmt::format("run.duration_s: {:.4g} s end before what theory expects at {:.4g} s",
                                                experiment.run.duration_s, *time_s));
}

}  // namespace

Eigen::Vector3d AtHeldHeight(const Experiment& experiment, Eigen::Vector3d value_m) {
  if (experiment.law.axes == Axes::kXyz) return value_m;
  value_m.z() = 0;
  for (const AgentConfig& agent : experiment.agents) value_m.z() += agent.p_W.z() / experiment.size();
  return value_m;
}

std::optional<Eigen::Vector3d> RestingLeader(const Experiment& experiment, bool flies) {
  const AgentConfig& leader = experiment.agent(experiment.law.leader);
  if (flies || !leader.v_W.head(AxisCount(experiment)).isZero(0)) return std::nullopt;
  return AtHeldHeight(experiment, leader.p_W);
}

Prediction Predict(Experiment& experiment) {
  Prediction prediction;
  if (experiment.law.name == "consensus") PredictConsensus(experiment, prediction);
  if (experiment.law.name == "waypoint") PredictWaypoint(experiment, prediction);
  if (experiment.law.name == "minmax") PredictMinmax(experiment, prediction);
  PredictFirstCommand(experiment, prediction);
  WarnOfShortRun(experiment, prediction);
  for (std::string& warning : CrowdingWarnings(experiment)) prediction.warnings.push_back(std::move(warning));
  return prediction;
}

}  // namespace mascot
