// Forward speed v and turning speed w for a wanted velocity u, with theta the heading and l = control.look_ahead_m:
//   v = u_x cos theta + u_y sin theta
//   w = (u_y cos theta - u_x sin theta) / l
// The point at distance l ahead of the centre then moves with exactly u: Lawton, Beard & Young, "A decentralized
// approach to formation maneuvers", IEEE Trans. Robotics and Automation 19 (2003). Our laws work with the centre
// itself, which follows the projection of u on the heading; that keeps the convergence of gradient laws: Zhao,
// Dimarogonas, Sun & Bauso, "A general approach to coordination control of mobile agents with motion constraints", IEEE
// Trans. Automatic Control 63 (2018).
#include <cmath>

#include "agent/controller.h"

namespace mascot {
namespace {

class UnicycleController final : public Controller {
 public:
  explicit UnicycleController(double look_ahead_m) : look_ahead_m_(look_ahead_m) {}

  Output Actuate(const Motion& self, const Eigen::Vector3d& u_W) override {
    const Eigen::Vector3d forward_W = self.q_WB * Eigen::Vector3d::UnitX();
    const Eigen::Vector2d ahead = forward_W.head<2>().normalized();
    const double v = u_W.x() * ahead.x() + u_W.y() * ahead.y();
    const double w = (u_W.y() * ahead.x() - u_W.x() * ahead.y()) / look_ahead_m_;
    return {.actuator = {v, w, 0, 0}, .flags = 0};
  }

 private:
  double look_ahead_m_;
};

}  // namespace

std::unique_ptr<Controller> MakeUnicycleController(const Experiment& experiment, int id) {
  return std::make_unique<UnicycleController>(experiment.agent(id).control.look_ahead_m);
}

}  // namespace mascot
