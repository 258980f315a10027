// Consensus of single integrators; Olfati-Saber & Murray, "Consensus problems in networks of agents with switching
// topology and time-delays", IEEE Trans. Automatic Control 49 (2004):
//   v_i = p_gain sum_j a_ij (p_j - p_i)
// A leader does not use what it hears, and wants the velocity 0.
#include "agent/laws/velocity_consensus.h"

#include <memory>

namespace mascot {
namespace {

struct VelocityConsensusParams final : LawParams {
  double p_gain = 0;  ///< 1/s
};

class VelocityConsensus final : public Law {
 public:
  explicit VelocityConsensus(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override {
    p_gain_ = agent.id == agent.law.leader ? 0 : ParamsOf<VelocityConsensusParams>(agent.law).p_gain;
  }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    Eigen::Vector3d pull_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) pull_W += j.weight * (j.motion.p_WB - self.p_WB);
    return p_gain_ * pull_W;
  }

 private:
  double p_gain_ = 0;
};

}  // namespace

std::shared_ptr<const LawParams> ReadVelocityConsensus(const Experiment& /*experiment*/, const LawConfig& /*law*/,
                                                       Section& section) {
  auto params = std::make_shared<VelocityConsensusParams>();
  params->p_gain = section.Number("p_gain");
  return params;
}

std::unique_ptr<Law> MakeVelocityConsensus(const Experiment& experiment, int id) {
  return std::make_unique<VelocityConsensus>(experiment.agent(id));
}

LinearForm LinearVelocityConsensus(const LawConfig& law) {
  return {.p = ParamsOf<VelocityConsensusParams>(law).p_gain};
}

}  // namespace mascot
