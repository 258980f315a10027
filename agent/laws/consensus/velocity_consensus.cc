// Consensus of single integrators; Olfati-Saber & Murray (2004):
//   v_i = p_gain sum_j a_ij (p_j - p_i)
// A leader does not use what it hears, and wants the velocity 0.
#include <memory>

#include "agent/laws/parts/pull.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr Key kVelocityConsensusParameters[] = {
    key::Number("p_gain", {0, 1000}, "pull towards each neighbour, times its weight").Default("1.0").Unit("1/s").Live(),
    key::Integer("leader", 0, kMaxAgents, "agent that leads, by wanting the velocity 0, 1..N; 0: none").Default("0"),
};

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
    return p_gain_ * Pull_W(self, heard);
  }

 private:
  double p_gain_ = 0;
};

std::shared_ptr<const LawParams> ReadVelocityConsensus(const Experiment& /*experiment*/, const LawConfig& /*law*/,
                                                       Section& section) {
  auto params = std::make_shared<VelocityConsensusParams>();
  params->p_gain = section.Number("p_gain");
  return params;
}

LinearForm LinearVelocityConsensus(const LawConfig& law) {
  return {.p = ParamsOf<VelocityConsensusParams>(law).p_gain};
}

}  // namespace

LawEntry VelocityConsensusLaw() {
  return {
      .name = "velocity_consensus",
      .summary = "single integrators meet: the law wants a velocity",
      .equation = "v_i = p_gain sum_j a_ij (p_j - p_i)",
      .tex = R"(v_i = k_p \sum_j a_{ij} (p_j - p_i))",
      .symbols = {{"p_gain", "k_p"}},
      .graph = "a directed spanning tree, with a leader one rooted at it",
      .details = "A leader wants the velocity 0.",
      .theory =
          "meets at g'p(0), g the left null vector of L, if a spanning tree exists; sampled with period T: p(k+1) = "
          "(I - T p_gain L) p(k), stable for T < 2 / (p_gain lambda_max) (undirected)",
      .source =
          "Olfati-Saber & Murray, Consensus problems in networks of agents with switching topology and time-delays, "
          "IEEE Trans. Autom. Control 49 (2004)",
      .parameters = kVelocityConsensusParameters,
      .agrees = true,
      .gathers = true,
      .drawing = {.pictures = kDisagreementPicture, .telling = "disagreement"},
      .read = ReadVelocityConsensus,
      .make = MakeOf<VelocityConsensus>,
      .wanted = WantsVelocity,
      .linear = LinearVelocityConsensus};
}

}  // namespace mascot
