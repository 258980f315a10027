// F = m a. With law.axes = "xy" the altitude loop holds the initial height: F_z = m (kp (z* - z) - kd v_z).
#include "agent/controller.h"

namespace mascot {
namespace {

class DoubleIntegratorController final : public Controller {
 public:
  DoubleIntegratorController(PdGains altitude, double height_m, bool holds_altitude)
      : altitude_(altitude), height_m_(height_m), holds_altitude_(holds_altitude) {}

  Output Actuate(const Motion& self, const Eigen::Vector3d& a_W) override {
    Eigen::Vector3d f_W = kDoubleIntegratorMass_kg * a_W;
    if (holds_altitude_)
      f_W.z() =
          kDoubleIntegratorMass_kg * (altitude_.kp * (height_m_ - self.p_WB.z()) + altitude_.kd * (0 - self.v_WB.z()));
    return {.actuator = {f_W.x(), f_W.y(), f_W.z(), 0}, .flags = 0};
  }

 private:
  PdGains altitude_;
  double height_m_;  // z*
  bool holds_altitude_;
};

}  // namespace

std::unique_ptr<Controller> MakeDoubleIntegratorController(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  return std::make_unique<DoubleIntegratorController>(agent.airframe.altitude, agent.p_W.z(),
                                                      agent.law.axes == Axes::kXy);
}

}  // namespace mascot
