// The wanted velocity is the command. With law.axes = "xy" the altitude loop holds the initial height:
//   v_z = (kp / kd) (z* - z)
// That is the velocity at which its PD law kp (z* - z) - kd v_z is 0. One tick corrects at most the whole error.
#include "agent/controller.h"

namespace mascot {
namespace {

class SingleIntegratorStack {
 public:
  SingleIntegratorStack(const AgentConfig& agent, double rate_hz)
      : height_m_(agent.p_W.z()), holds_altitude_(agent.law.axes == Axes::kXy) {
    const PdGains& gains = agent.airframe.altitude;
    if (gains.kp > 0) climb_per_s_ = gains.kp < gains.kd * rate_hz ? gains.kp / gains.kd : rate_hz;
  }

  Actuation Actuate(const Motion& self, const Eigen::Vector3d& v_W) const {
    return {v_W.x(), v_W.y(), holds_altitude_ ? climb_per_s_ * (height_m_ - self.p_WB.z()) : v_W.z(), 0};
  }

 private:
  double climb_per_s_ = 0;
  double height_m_;  // z*
  bool holds_altitude_;
};

}  // namespace

std::unique_ptr<Controller> MakeSingleIntegratorController(const Experiment& experiment, std::span<const int> ids) {
  std::vector<SingleIntegratorStack> stacks;
  for (const int id : ids) stacks.emplace_back(experiment.agent(id), experiment.control.rate_hz);
  return std::make_unique<EachByItself<SingleIntegratorStack>>(std::move(stacks));
}

}  // namespace mascot
