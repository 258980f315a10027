// Single integrator: dp/dt = u, the velocity u in W. The model that first-order theory assumes.
#include "physics_server/models/ball.h"

namespace mascot {
namespace {

class SingleIntegrator final : public Ball {
 public:
  Push Apply(const Actuation& command, const BodyNow& /*self*/, const Surroundings& /*around*/) override {
    return {.velocity = Push::Velocity{{command[0], command[1], command[2]}, Eigen::Vector3d::Zero()}};
  }
  PushLimit LimitOf(const Actuation& command) const override {
    return {.speed_m_per_s = Eigen::Vector3d(command[0], command[1], command[2]).norm()};
  }
};

}  // namespace

std::unique_ptr<Model> MakeSingleIntegrator(const Experiment& /*experiment*/, int /*id*/) {
  return std::make_unique<SingleIntegrator>();
}

}  // namespace mascot
