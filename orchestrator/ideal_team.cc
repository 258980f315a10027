#include "orchestrator/ideal_team.h"

#include "agent/hear.h"

namespace mascot {

IdealTeam::IdealTeam(Experiment& experiment)
    : experiment_(experiment),
      motions_(static_cast<std::size_t>(experiment.size())),
      u_W_(static_cast<std::size_t>(experiment.size())) {
  for (const AgentConfig& config : experiment.agents) {
    agents_.push_back(std::make_unique<Agent>(experiment, config.id));
    Motion& motion = motions_[static_cast<std::size_t>(config.id - 1)];
    motion.p_WB = config.p_W;
    motion.v_WB = config.v_W;
  }
}

void IdealTeam::Step() {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    HearAll(experiment_.graph, agents_[i]->id(), motions_, heard_);
    u_W_[i] = agents_[i]->Want(tick_, motions_[i], heard_).a_limited_W;
  }
  const double h = experiment_.period_s();
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    motions_[i].p_WB += h * motions_[i].v_WB + 0.5 * h * h * u_W_[i];
    motions_[i].v_WB += h * u_W_[i];
    motions_[i].a_WB = u_W_[i];
  }
  ++tick_;
}

}  // namespace mascot
