#include "orchestrator/theory.h"

#include <spdlog/fmt/fmt.h>

#include "agent/laws.h"
#include "orchestrator/crowding.h"
#include "orchestrator/theory_parts.h"

namespace mascot {
namespace {

/// What agent `id` hears at tick 0.
std::vector<Heard> HeardAtStart(const Experiment& experiment, int id) {
  std::vector<Heard> heard;
  for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id)) {
    heard.push_back({neighbour.id, neighbour.weight, {}});
    heard.back().motion.p_WB = experiment.agent(neighbour.id).p_W;
    heard.back().motion.v_WB = experiment.agent(neighbour.id).v_W;
  }
  return heard;
}

void PredictFirstCommand(Experiment& experiment, Prediction& prediction) {
  double largest = 0;
  int of = 1;
  for (const AgentConfig& agent : experiment.agents) {
    Motion self;
    self.p_WB = agent.p_W;
    self.v_WB = agent.v_W;
    const Eigen::Vector3d a_W = MakeLaw(experiment, agent.id)->Accel_W(0, self, HeardAtStart(experiment, agent.id));
    const double asked = a_W.head(AxisCount(experiment)).cwiseAbs().maxCoeff();
    if (asked > largest) {
      largest = asked;
      of = agent.id;
    }
  }
  prediction.first_command_m_per_s2 = largest;
  const double limit = experiment.control.max_acceleration_m_per_s2;
  if (largest <= limit || experiment.law.name == "minmax") return;  // minmax: WarnOfCutBeta has said so
  prediction.warnings.push_back(fmt::format(
      "control.max_acceleration_m_per_s2: the first command would already saturate: agent {} asks for {:.4g} m/s^2, "
      "the limit is {:.4g}",
      of, largest, limit));
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
