// Consensus with bounded accelerations: W. Ren, "On consensus algorithms for double-integrator dynamics", IEEE
// Transactions on Automatic Control 53 (6), 2008:
//
//   a_i = sum_j a_ij [ tanh(p_gain (p_j - p_i)) + tanh(v_gain (v_j - v_i)) ]     (tanh of each component)
//
// However far apart the agents start, no component exceeds 2 sum_j a_ij. On a connected undirected graph all meet: what
// i wants for j's sake is the opposite of what j wants for i's, so that the mean position moves on as it started.

#include "mascot/plugin.h"

namespace {

class BoundedConsensus final : public mascot::Law {
 public:
  // Called once per agent, before the run. A parameter that is missing, of the wrong type or out of range is refused by
  // `orchestrator check` with file, line and column; so is one that nobody asks for here.
  explicit BoundedConsensus(const mascot::PluginSetup& setup)
      : p_gain_(setup.params.Number("p_gain", 0, 100)),         // 1/m, required
        v_gain_(setup.params.Number("v_gain", 0, 100, 1.0)) {}  // s/m, 1 unless the file says otherwise

  // Called at every tick: what this agent wants, knowing where it is itself and what it heard at this tick. Everything
  // is in the world frame (x east, y north, z up): m, m/s, and m/s^2 for the answer.
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
