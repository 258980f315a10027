#pragma once

#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/team/team.h"
#include "physics_server/world.h"

namespace mascot {

/// Runs an experiment as the engines do, with links, laws, limits, low-level controllers and bodies, but without DDS
/// and files.
class FlownNetwork {
 public:
  explicit FlownNetwork(const std::string& toml)
      : experiment(LoadExperiment(Section::FromText(toml, "test.toml"), "test")),
        world(experiment),
        team(experiment),
        motions(experiment.agents.size()),
        commands(experiment.agents.size()),
        actuation(experiment.agents.size()) {
    Look();
  }

  void Step() {
    team.Decide(world.tick(), motions, commands);
    for (std::size_t i = 0; i < commands.size(); ++i) actuation[i] = commands[i].actuator;
    world.Step(actuation);
    Look();
  }
  void RunUntil(double end_s) {
    while (experiment.time_s(world.tick()) < end_s - 1e-9) Step();
  }

  const Motion& agent(int id) const { return motions[static_cast<std::size_t>(id - 1)]; }
  /// x of all agents (m, in W), by id.
  Eigen::VectorXd x() const {
    Eigen::VectorXd x(std::ssize(motions));
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = motions[static_cast<std::size_t>(i)].p_WB.x();
    return x;
  }

  Experiment experiment;
  World world;
  Team team;
  std::vector<Motion> motions;
  std::vector<Command> commands;
  std::vector<Actuation> actuation;

 private:
  void Look() {
    for (const AgentConfig& agent : experiment.agents)
      motions[static_cast<std::size_t>(agent.id - 1)] = world.State(agent.id);
  }
};

}  // namespace mascot
