// F = m a. With law.axes = "xy" the altitude loop holds the initial height: F_z = m (kp (z* - z) - kd v_z).
#include "agent/controller.h"

namespace mascot {
namespace {

class DoubleIntegratorStack {
 public:
  explicit DoubleIntegratorStack(const AgentConfig& agent)
      : altitude_(agent.airframe.altitude), height_m_(agent.p_W.z()), holds_altitude_(agent.law.axes == Axes::kXy) {}

  Actuation Actuate(const Motion& self, const Eigen::Vector3d& a_W) const {
    Eigen::Vector3d f_W = kDoubleIntegratorMass_kg * a_W;
    if (holds_altitude_)
      f_W.z() =
          kDoubleIntegratorMass_kg * (altitude_.kp * (height_m_ - self.p_WB.z()) + altitude_.kd * (0 - self.v_WB.z()));
    return {f_W.x(), f_W.y(), f_W.z(), 0};
  }

 private:
  PdGains altitude_;
  double height_m_;  // z*
  bool holds_altitude_;
};

}  // namespace

std::unique_ptr<Controller> MakeDoubleIntegratorController(const Experiment& experiment, std::span<const int> ids) {
  std::vector<DoubleIntegratorStack> stacks;
  for (const int id : ids) stacks.emplace_back(experiment.agent(id));
  return std::make_unique<EachByItself<DoubleIntegratorStack>>(std::move(stacks));
}

}  // namespace mascot
