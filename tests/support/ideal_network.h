#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/sensor.h"
#include "experiment/experiment.h"

namespace mascot {

/// The agents of an experiment as ideal double integrators whose acceleration is held for one tick:
///   p+ = p + h v + h^2 u / 2,  v+ = v + h u
/// or, where their law wants a velocity, as single integrators: p+ = p + h u.
/// Tests the law alone: no limits, bodies or delays. A law that takes actions is given 1 for each of its numbers.
class IdealNetwork {
 public:
  explicit IdealNetwork(const std::string& toml)
      : IdealNetwork(LoadExperiment(Section::FromText(toml, "test.toml"), "test")) {}
  explicit IdealNetwork(Experiment flown) : experiment(std::move(flown)) {
    for (const AgentConfig& agent : experiment.agents) {
      laws.push_back(MakeLaw(experiment, agent.id));
      laws.back()->Act(std::vector<double>(agent.law.params->action, 1.0));
      ranges.emplace_back(experiment.sensors.range_m, experiment.physics.obstacles);
      motions.emplace_back();
      motions.back().p_WB = agent.p_W;
      motions.back().v_WB = agent.v_W;
    }
    messages.resize(motions.size());
  }

  double h() const { return experiment.period_s(); }
  double time_s() const { return experiment.time_s(tick); }
  Motion& agent(int id) { return motions[static_cast<std::size_t>(id - 1)]; }

  /// Output of each agent's law at the current tick, along law.axes, in W: acceleration (m/s^2) or velocity (m/s),
  /// whichever the law wants.
  std::vector<Eigen::Vector3d> Wants() {
    std::vector<Eigen::Vector3d> wants_W;
    for (int id = 1; id <= experiment.size(); ++id) {
      std::vector<Heard> heard;
      for (const Graph::Neighbour& j : experiment.graph.HeardBy(id))
        heard.push_back({j.id, j.weight, agent(j.id), 0, messages[static_cast<std::size_t>(j.id - 1)]});
      const auto i = static_cast<std::size_t>(id - 1);
      if (ranges[i].is_on()) laws[i]->See(ranges[i].Sense(agent(id).p_WB));
      wants_W.push_back(laws[i]->Want_W(time_s(), agent(id), heard));
      if (experiment.law.axes == Axes::kXy) wants_W.back().z() = 0;
    }
    return wants_W;
  }

  void Step() {
    const std::vector<Eigen::Vector3d> wants_W = Wants();
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!experiment.agents[i].sends_messages) continue;
      const std::span<const double> message = laws[i]->Message();
      messages[i].assign(message.begin(), message.end());
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (laws[i]->wanted() == Wanted::kVelocity) {
        motions[i].a_WB = (wants_W[i] - motions[i].v_WB) / h();
        motions[i].v_WB = wants_W[i];
        motions[i].p_WB += h() * motions[i].v_WB;
        continue;
      }
      motions[i].p_WB += h() * motions[i].v_WB + h() * h() / 2 * wants_W[i];
      motions[i].v_WB += h() * wants_W[i];
      motions[i].a_WB = wants_W[i];
    }
    ++tick;
  }

  void RunUntil(double end_s) {
    while (time_s() < end_s) Step();
  }

  Experiment experiment;
  std::vector<std::unique_ptr<Law>> laws;
  std::vector<RangeSensor> ranges;
  std::vector<Motion> motions;
  std::vector<std::vector<double>> messages;  ///< of the last tick, by id - 1; empty: none was sent
  std::int64_t tick = 0;
};

}  // namespace mascot
