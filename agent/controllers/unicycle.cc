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

class UnicycleStack {
 public:
  explicit UnicycleStack(const AgentConfig& agent) : look_ahead_m_(agent.control.look_ahead_m) {}

  Actuation Actuate(const Motion& self, const Eigen::Vector3d& u_W) const {
    const Eigen::Vector3d forward_W = self.q_WB * Eigen::Vector3d::UnitX();
    const Eigen::Vector2d ahead = forward_W.head<2>().normalized();
    const double v = u_W.x() * ahead.x() + u_W.y() * ahead.y();
    const double w = (u_W.y() * ahead.x() - u_W.x() * ahead.y()) / look_ahead_m_;
    return {v, w, 0, 0};
  }

 private:
  double look_ahead_m_;
};

}  // namespace

std::unique_ptr<Controller> MakeUnicycleController(const Experiment& experiment, std::span<const int> ids) {
  std::vector<UnicycleStack> stacks;
  for (const int id : ids) stacks.emplace_back(experiment.agent(id));
  return std::make_unique<EachByItself<UnicycleStack>>(std::move(stacks));
}

}  // namespace mascot
