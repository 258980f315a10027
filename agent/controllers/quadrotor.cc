// The low-level stack of the MASCOT paper (Pandit, Njattuvetty, Mulla): PD loops turn a wanted acceleration into rotor
// speeds. With our axes (x forward, y left, z up; phi, theta, psi: roll, pitch, yaw about them):
//   reference:  a   = a_W + kp (p* - p) + kd (v* - v) + B v / m    with p*'' = a_W; in z, the altitude loop
//   thrust:     T   = m (a_z + g)
//   inversion:  a in the heading frame -> phi*, theta*             small: phi* = -a_left / g, theta* = a_forward / g
//   attitude:   tau = J (kp (phi* - phi) - kd phi')                same for theta; psi goes to control.heading_rad
//   rotors:     [w1^2 .. w4^2] = A^-1 [T, tau]
// The reference p*, v* is the ideal double integrator of the theory: it starts where the agent starts, and integrates
// the limited accelerations of the law; where a fresh agent takes the place of one, it begins anew. Tracking it gives
// back the velocity that the body loses while it tilts. With law.axes = "xy", z* stays the initial height and v_z* = 0.
// Gains: airframe.position in x and y, airframe.altitude in z.
//
// Agents are computed several at once (agent/controllers/lanes/actuate_in_lanes.h), to the same bits whatever the
// number of lanes.
#include "agent/controllers/quadrotor.h"

#include <Eigen/LU>
#include <limits>
#include <utility>
#include <vector>

#include "agent/controllers/lanes/quadrotor_kernel.h"
#include "base/lane_numbers.h"

namespace mascot {
namespace {

using F = StackField;

/// The kernels that this processor can run, the one with most lanes first.
std::vector<QuadrotorKernel> Kernels() {
  std::vector<QuadrotorKernel> kernels;
#ifdef MASCOT_AVX
  if (__builtin_cpu_supports("avx")) kernels.push_back(QuadrotorsByAvx());
#endif
  kernels.push_back(QuadrotorsByDefault());
  return kernels;
}

class QuadrotorController final : public Controller {
 public:
  QuadrotorController(const Experiment& experiment, std::span<const int> ids, QuadrotorKernel kernel)
      : kernel_(kernel), numbers_(ids.size(), F::kCount, kernel.lanes) {
    for (std::size_t i = 0; i < ids.size(); ++i) Begin(experiment, experiment.agent(ids[i]), i);
  }

  void Actuate(std::span<const Input> inputs, std::span<Output> outputs) override {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const Motion& self = *inputs[i].self;
      Put(self.p_WB, i, F::kP);
      Put(self.v_WB, i, F::kV);
      Put(self.q_WB.coeffs(), i, F::kQ);
      Put(self.w_WB_B, i, F::kWInB);
      Put(inputs[i].wanted_W, i, F::kWanted);
    }
    for (const std::size_t i : std::exchange(fresh_, {})) {
      const int axes = numbers_.At(i, F::kHoldsAltitude) != 0 ? 2 : 3;
      for (int axis = 0; axis < axes; ++axis) {
        numbers_.At(i, F::kPRef + axis) = numbers_.At(i, F::kP + axis);
        numbers_.At(i, F::kVRef + axis) = numbers_.At(i, F::kV + axis);
      }
    }
    kernel_.actuate(numbers_.Block(0), numbers_.blocks());
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      Output& output = outputs[i];
      for (int k = 0; k < 4; ++k) output.actuator[static_cast<std::size_t>(k)] = numbers_.At(i, F::kRotors + k);
      output.flags = (numbers_.At(i, F::kIsTiltLimited) != 0 ? kTiltLimited : 0u) |
                     (numbers_.At(i, F::kIsRotorLimited) != 0 ? kRotorLimited : 0u);
    }
  }

  void Restart(std::size_t i) override { fresh_.push_back(i); }

 private:
  template <class Vector>
  void Put(const Vector& vector, std::size_t i, int field) {
    for (int k = 0; k < vector.size(); ++k) numbers_.At(i, field + k) = vector[k];
  }
  void Put(const PdGains& gains, std::size_t i, int field) {
    numbers_.At(i, field) = gains.kp;
    numbers_.At(i, field + 1) = gains.kd;
  }

  void Begin(const Experiment& experiment, const AgentConfig& agent, std::size_t i) {
    const Airframe& airframe = agent.airframe;
    const bool holds_altitude = agent.law.axes == Axes::kXy;
    const auto at = [&](int field) -> double& { return numbers_.At(i, field); };
    Put(agent.p_W, i, F::kPRef);
    Put(agent.v_W, i, F::kVRef);
    if (holds_altitude) at(F::kVRef + 2) = 0;
    at(F::kHoldsAltitude) = holds_altitude;
    at(F::kIsExact) = agent.control.inversion == Inversion::kExact;
    at(F::kPeriod) = experiment.period_s();
    at(F::kHeading) = agent.control.heading_rad;
    at(F::kDragPerS) = agent.control.drag_compensation ? airframe.linear_drag_kg_per_s / airframe.mass_kg : 0;
    at(F::kGravity) = experiment.physics.gravity_m_per_s2;
    at(F::kMass) = airframe.mass_kg;
    at(F::kTiltLimit) = airframe.tilt_limit_rad;
    at(F::kMinUp) = airframe.MinCommandedThrust() / airframe.mass_kg;
    Put(airframe.position, i, F::kPosition);
    Put(airframe.altitude, i, F::kAltitude);
    Put(airframe.heading, i, F::kHeadingGains);
    Put(airframe.attitude, i, F::kAttitude);
    at(F::kMaxTurn) = airframe.attitude.kd > 0 ? airframe.attitude.kd * Airframe::kMaxTurnRate
                                               : std::numeric_limits<double>::infinity();
    Put(airframe.inertia_kg_m2, i, F::kInertia);
    at(F::kMinThrust) = airframe.MinCommandedThrust();
    at(F::kMaxThrust) = airframe.MaxCommandedThrust();
    at(F::kMaxSquared) = airframe.max_thrust_n / (4 * airframe.lift_n_s2);
    const Eigen::Matrix4d inverse = airframe.Allocation().inverse();
    for (int row = 0; row < 4; ++row) Put(inverse.row(row), i, F::kMixer + 4 * row);
  }

  QuadrotorKernel kernel_;
  LaneNumbers numbers_;
  std::vector<std::size_t> fresh_;  // whose references begin anew
};

}  // namespace

std::unique_ptr<Controller> MakeQuadrotorController(const Experiment& experiment, std::span<const int> ids) {
  return MakeQuadrotorController(experiment, ids, static_cast<int>(ids.size()));
}

std::unique_ptr<Controller> MakeQuadrotorController(const Experiment& experiment, std::span<const int> ids,
                                                    int max_lanes) {
  return std::make_unique<QuadrotorController>(experiment, ids, KernelWith(Kernels(), max_lanes));
}

std::vector<int> LanesOfQuadrotors() { return LanesOf(Kernels()); }

}  // namespace mascot
