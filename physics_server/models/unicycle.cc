// Unicycle: rolls forward and turns in the horizontal plane of its start, without slipping sideways:
//   dx/dt = v cos theta,   dy/dt = v sin theta,   d theta/dt = w
// With v and w held for dt it rolls along an arc. The chord of the arc is v dt sin(a)/a long, with a = w dt/2, in the
// direction theta + a. Bullet moves a body straight during a step: we move it along the chord, so that it ends on the
// arc.
#include <cmath>

#include "physics_server/models/ball.h"

namespace mascot {
namespace {

class Unicycle final : public Ball {
 public:
  bool touches_ground() const override { return false; }

  Push Apply(const Actuation& command, const BodyNow& self, const Surroundings& around) override {
    const double v = command[0], w = command[1];
    const Eigen::Vector3d forward_W = self.R_WB.col(0);
    const double half_turn = w * around.dt_s / 2;
    const double chord = std::atan2(forward_W.y(), forward_W.x()) + half_turn;
    const double speed = half_turn == 0 ? v : v * std::sin(half_turn) / half_turn;
    return {.velocity = Push::Velocity{{speed * std::cos(chord), speed * std::sin(chord), 0}, {0, 0, w}}};
  }
  PushLimit LimitOf(const Actuation& command) const override { return {.speed_m_per_s = std::abs(command[0])}; }
};

}  // namespace

std::unique_ptr<Model> MakeUnicycle(const Experiment& /*experiment*/, int /*id*/) {
  return std::make_unique<Unicycle>();
}

}  // namespace mascot
