// Consensus with bounded accelerations: W. Ren, "On consensus algorithms for double-integrator dynamics", IEEE
// Transactions on Automatic Control 53 (6), 2008:
//
//   a_i = sum_j a_ij [ tanh(p_gain (p_j - p_i)) + tanh(v_gain (v_j - v_i)) ]     (tanh of each component)
//
// No component of a_i exceeds 2 sum_j a_ij, however far apart the agents start. On a connected undirected graph all
// agents meet. The terms of each pair i, j cancel in the sum over all agents, so the mean velocity stays constant.

#include "mascot/plugin.h"

namespace {

class BoundedConsensus final : public mascot::Law {
 public:
  // Called once per agent before the run, and in `orchestrator check`. A parameter that is missing, of the wrong type
  // or out of range is refused with file, line and column. A parameter that is not read here is refused, too.
  explicit BoundedConsensus(const mascot::PluginSetup& setup)
      : p_gain_(setup.params.Number("p_gain", 0, 100)),         // 1/m, required
        v_gain_(setup.params.Number("v_gain", 0, 100, 1.0)) {}  // s/m, default 1

  // Called at every tick. Returns the acceleration (m/s^2) that this agent wants, from its own motion and the samples
  // heard at this tick. Positions (m), velocities (m/s) and the result are in the world frame: x east, y north, z up.
  Eigen::Vector3d Want_W(double /*t_s*/, const mascot::Motion& self, std::span<const mascot::Heard> heard) override {
    Eigen::Vector3d a_W = Eigen::Vector3d::Zero();
    for (const mascot::Heard& j : heard) {
      const Eigen::Array3d towards = p_gain_ * (j.motion.p_WB - self.p_WB);
      const Eigen::Array3d along = v_gain_ * (j.motion.v_WB - self.v_WB);
      a_W += j.weight * (towards.tanh() + along.tanh()).matrix();
    }
    return a_W;
  }

 private:
  double p_gain_;
  double v_gain_;
};

}  // namespace

MASCOT_PLUGIN_LAW(BoundedConsensus)
