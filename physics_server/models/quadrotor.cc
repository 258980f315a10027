// The quadrotor of the MASCOT paper (Pandit, Njattuvetty, Mulla), with our axes (z_B up):
//   m dv/dt = m g_W + R_WB [0, 0, T] - B (v - wind),   [T, Gamma] = A [w1^2 .. w4^2],   J dw/dt = -w x J w + Gamma
// Rotor speeds follow the command between 0 and their maximum, with a first-order lag if the airframe has one. A failed
// rotor still follows its command, but only the remaining part of its thrust and torque acts. World adds gravity and
// the gyroscopic term -w x J w.
#include <algorithm>
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
        rotors_{.allocation = airframe.Allocation(),
                .max_speed_rad_per_s = airframe.MaxRotorSpeed(),
                .time_constant_s = airframe.rotor_time_constant_s,
                .drag_kg_per_s = airframe.linear_drag_kg_per_s,
                .failures = std::move(failures),
                .speed_rad_per_s = Eigen::Vector4d::Constant(
                    std::min(airframe.HoverRotorSpeed(gravity_m_per_s2), airframe.MaxRotorSpeed()))} {}

  double mass_kg() const override { return airframe_.mass_kg; }
  Eigen::Vector3d inertia_kg_m2() const override { return airframe_.inertia_kg_m2; }
  Eigen::Vector3d half_size_m() const override { return airframe_.size_m / 2; }
  bool feels_gravity() const override { return true; }
  Rotors* rotors() override { return &rotors_; }

  // physics_server/lanes/fly_in_lanes.h does the same for several bodies at once.
  Push Apply(const Actuation& command, const BodyNow& self, const Surroundings& around) override {
    Eigen::Vector4d& speed = rotors_.speed_rad_per_s;
    const Eigen::Vector4d wanted =
        Eigen::Vector4d::Map(command.data()).cwiseMax(0).cwiseMin(rotors_.max_speed_rad_per_s);
    speed += rotors_.Followed(around.dt_s) * (wanted - speed);
    const Eigen::Vector4d thrust_torque =
        rotors_.allocation * rotors_.Remaining(around.t_s).cwiseProduct(speed.cwiseAbs2());
    const Eigen::Vector3d drag_W = -rotors_.drag_kg_per_s * (self.v_WB - around.wind_W);
    return {.f_W = thrust_torque[0] * self.R_WB.col(2) + drag_W, .tau_B = thrust_torque.tail<3>()};
  }

  // No rotor gives more of anything than at its maximum.
  PushLimit LimitOf(const Actuation& /*command*/) const override {
    const Eigen::Vector4d all = Eigen::Vector4d::Constant(rotors_.max_speed_rad_per_s * rotors_.max_speed_rad_per_s);
    const Eigen::Vector4d most = rotors_.allocation.cwiseAbs() * all;
    return {.force_n = most[0], .torque_nm = most.tail<3>().norm(), .drag_kg_per_s = rotors_.drag_kg_per_s};
  }

 private:
  Airframe airframe_;
  Rotors rotors_;
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
