// The quadrotor of the MASCOT paper (Pandit, Njattuvetty, Mulla), with our axes (z_B up):
//   m dv/dt = m g_W + R_WB [0, 0, T] - B (v - wind),   [T, Gamma] = A [w1^2 .. w4^2],   J dw/dt = -w x J w + Gamma
// Rotor speeds follow the command between 0 and their maximum, with a first-order lag if the airframe has one. A failed
// rotor still follows its command, but only the remaining part of its thrust and torque acts. World adds gravity and
// the gyroscopic term -w x J w.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "physics_server/model.h"

namespace mascot {
namespace {

class Quadrotor final : public Model {
 public:
  Quadrotor(const Airframe& airframe, double gravity_m_per_s2, std::vector<RotorFailure> failures)
      : airframe_(airframe),
        failures_(std::move(failures)),
        allocation_(airframe.Allocation()),
        max_rotor_speed_(airframe.MaxRotorSpeed()),
        rotor_speed_(
            Eigen::Vector4d::Constant(std::min(airframe.HoverRotorSpeed(gravity_m_per_s2), max_rotor_speed_))) {}

  double mass_kg() const override { return airframe_.mass_kg; }
  Eigen::Vector3d inertia_kg_m2() const override { return airframe_.inertia_kg_m2; }
  Eigen::Vector3d half_size_m() const override { return airframe_.size_m / 2; }
  bool feels_gravity() const override { return true; }

  Push Apply(const Actuation& command, const BodyNow& self, const Surroundings& around) override {
    const Eigen::Vector4d wanted = Eigen::Vector4d::Map(command.data()).cwiseMax(0).cwiseMin(max_rotor_speed_);
    rotor_speed_ += Followed(around.dt_s) * (wanted - rotor_speed_);
    const Eigen::Vector4d thrust_torque = allocation_ * Remaining(around.t_s).cwiseProduct(rotor_speed_.cwiseAbs2());
    const Eigen::Vector3d drag_W = -airframe_.linear_drag_kg_per_s * (self.v_WB - around.wind_W);
    return {.f_W = thrust_torque[0] * self.R_WB.col(2) + drag_W, .tau_B = thrust_torque.tail<3>()};
  }

 private:
  // Part of the way to a constant command that a rotor speed goes in dt; exact for a first-order lag.
  double Followed(double dt_s) const {
    const double lag_s = airframe_.rotor_time_constant_s;
    return lag_s > 0 ? -std::expm1(-dt_s / lag_s) : 1;
  }

  /// Part of each rotor's thrust and torque that is left.
  Eigen::Vector4d Remaining(double t_s) const {
    constexpr double kRounding_s = 1e-9;
    Eigen::Vector4d remaining = Eigen::Vector4d::Ones();
    for (const RotorFailure& failure : failures_)
      if (failure.at_s <= t_s + kRounding_s) remaining[failure.rotor - 1] = failure.remaining;
    return remaining;
  }

  Airframe airframe_;
  std::vector<RotorFailure> failures_;  // in order of time: the last that has begun counts
  Eigen::Matrix4d allocation_;          // A
  double max_rotor_speed_;              // rad/s
  Eigen::Vector4d rotor_speed_;         // rad/s; starts at hover
};

}  // namespace

std::unique_ptr<Model> MakeQuadrotor(const Experiment& experiment, int id) {
  std::vector<RotorFailure> failures;
  std::ranges::copy_if(experiment.physics.rotor_failures, std::back_inserter(failures),
                       [id](const RotorFailure& failure) { return failure.agent == id; });
  std::ranges::stable_sort(failures, {}, &RotorFailure::at_s);
  return std::make_unique<Quadrotor>(experiment.agent(id).airframe, experiment.physics.gravity_m_per_s2,
                                     std::move(failures));
}

}  // namespace mascot
