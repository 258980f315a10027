// Double integrator: m dv/dt = u, the force u in W; no gravity, no drag. The model that the theory of most laws
// assumes.
#include "physics_server/models/ball.h"

namespace mascot {
namespace {

class DoubleIntegrator final : public Ball {
 public:
  Push Apply(const Actuation& command, const BodyNow& /*self*/, const Surroundings& /*around*/) override {
    return {.f_W = {command[0], command[1], command[2]}};
  }
  PushLimit LimitOf(const Actuation& command) const override {
    return {.force_n = Eigen::Vector3d(command[0], command[1], command[2]).norm()};
  }
};

}  // namespace

std::unique_ptr<Model> MakeDoubleIntegrator(const Experiment& /*experiment*/, int /*id*/) {
  return std::make_unique<DoubleIntegrator>();
}

}  // namespace mascot
