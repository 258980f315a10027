// The wanted velocity is the command. With law.axes = "xy" the altitude loop holds the initial height:
//   v_z = (kp / kd) (z* - z)
// That is the velocity at which its PD law kp (z* - z) - kd v_z is 0. One tick corrects at most the whole error.
#include <algorithm>

#include "agent/controller.h"

namespace mascot {
namespace {

class SingleIntegratorController final : public Controller {
 public:
  SingleIntegratorController(PdGains altitude, double rate_hz, double height_m, bool holds_altitude)
      : climb_per_s_(altitude.kp < altitude.kd * rate_hz ? altitude.kp / altitude.kd
                     : altitude.kp > 0                   ? rate_hz
                                                         : 0),
        height_m_(height_m),
        holds_altitude_(holds_altitude) {}

  Output Actuate(const Motion& self, const Eigen::Vector3d& v_W) override {
    const double v_z = holds_altitude_ ? climb_per_s_ * (height_m_ - self.p_WB.z()) : v_W.z();
    return {.actuator = {v_W.x(), v_W.y(), v_z, 0}, .flags = 0};
  }

 private:
  double climb_per_s_;
  double height_m_;  // z*
  bool holds_altitude_;
};

}  // namespace

std::unique_ptr<Controller> MakeSingleIntegratorController(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  return std::make_unique<SingleIntegratorController>(agent.airframe.altitude, experiment.control.rate_hz,
                                                      agent.p_W.z(), agent.law.axes == Axes::kXy);
}

}  // namespace mascot
