#include "orchestrator/team/ideal_team.h"

namespace mascot {
namespace {

void Move(Wanted driven_by, const Command& command, double h, Motion& motion) {
  const Eigen::Vector3d v_W =
      driven_by == Wanted::kVelocity ? command.v_limited_W : motion.v_WB + h * command.a_limited_W;
  if (driven_by == Wanted::kVelocity)
    motion.p_WB += h * v_W;
  else
    motion.p_WB += h * motion.v_WB + 0.5 * h * h * command.a_limited_W;
  motion.a_WB = driven_by == Wanted::kVelocity ? (v_W - motion.v_WB) / h : command.a_limited_W;
  motion.v_WB = v_W;
}

}  // namespace

IdealTeam::IdealTeam(const Experiment& experiment, Crew& crew)
    : experiment_(experiment),
      team_(experiment, crew),
      motions_(static_cast<std::size_t>(experiment.size())),
      commands_(static_cast<std::size_t>(experiment.size())) {
  for (const AgentConfig& config : experiment.agents) {
    Motion& motion = motions_[static_cast<std::size_t>(config.id - 1)];
    motion.p_WB = config.p_W;
    motion.v_WB = config.v_W;
    const double heading_rad = config.traits().turns_to_heading ? config.control.heading_rad : config.heading_rad;
    motion.q_WB = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ());  // a law may use it
  }
}

void IdealTeam::Step() {
  team_.Want(tick_, motions_, commands_, experiment_.run.on_agent_loss == OnAgentLoss::kAbort ? nullptr : &failures_);
  for (const AgentConfig& config : experiment_.agents) {
    const auto i = static_cast<std::size_t>(config.id - 1);
    Move(config.traits().driven_by, commands_[i], experiment_.period_s(), motions_[i]);
  }
  ++tick_;
}

}  // namespace mascot
