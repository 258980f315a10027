// Claims about two flights, one before and one after a key of the experiment is changed: which commands agents give, by
// the equations of the law and of the low-level stack, and how their bodies move.
#pragma once

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/team/row_sink.h"
#include "tests/support/folders.h"

namespace mascot::test {

/// A run in the process of the test, with all that a recording has of every tick.
class Flight final : private RowSink {
 public:
  /// Flies configs/leaderless.toml with these overrides.
  explicit Flight(const std::vector<Override>& overrides)
      : experiment(
            LoadExperiment(Section::FromFile(SourceFolder() + "/configs/leaderless.toml", overrides), "leaderless")) {
    EXPECT_EQ(RunInProcess(experiment, {this}, [] { return true; }).failure, "");
  }

  const Experiment experiment;

  int agents() const { return experiment.size(); }
  /// Ticks at which agents decide: the last row of a run has no commands.
  int ticks() const { return static_cast<int>(rows_.size()) - 1; }
  double T() const { return experiment.period_s(); }
  const Motion& at(int id, int tick) const { return Row(tick).motions[static_cast<std::size_t>(id - 1)]; }
  const Command& command(int id, int tick) const { return Row(tick).commands[static_cast<std::size_t>(id - 1)]; }
  const Airframe& airframe(int id) const { return experiment.agent(id).airframe; }
  /// Thrust (N) and torques (N m) of the commanded rotor speeds.
  Eigen::Vector4d ThrustAndTorque(int id, int tick) const {
    return airframe(id).Allocation() * Eigen::Vector4d::Map(command(id, tick).actuator.data()).cwiseAbs2();
  }
  /// All numbers of the row of a tick, in the order of states.npz.
  std::vector<double> Numbers(int tick) const {
    std::vector<double> numbers;
    StateRow row(agents());
    row.Set(experiment.time_s(tick), Row(tick));
    for (std::size_t k = 0; k < kStateArrays.size(); ++k)
      numbers.insert(numbers.end(), row.Values(k).begin(), row.Values(k).end());
    return numbers;
  }

 private:
  void Add(const FlownRow& row) override { rows_.push_back(row.decoded()); }
  const DecodedRow& Row(int tick) const { return rows_.at(static_cast<std::size_t>(tick)); }
  std::vector<DecodedRow> rows_;
};

/// Calls `look(id, tick)` for all agents and all ticks in [from, to).
inline void ForAll(const Flight& flight, const std::function<void(int, int)>& look, int from = 0, int to = 1 << 30) {
  for (int tick = from; tick < std::min(to, flight.ticks()); ++tick)
    for (int id = 1; id <= flight.agents(); ++id) look(id, tick);
}

// --- the law ----------------------------------------------------------------------------------------

/// Weight with which agent i hears what agent j has sent at a tick; 0: i does not hear j.
using Weight = std::function<double(const Flight& flight, int i, int j, int tick)>;

inline Weight Everyone() {
  return [](const Flight&, int i, int j, int) { return i == j ? 0.0 : 1.0; };
}
/// Agent i hears agent j with weights[i - 1][j - 1].
inline Weight Matrix(std::vector<std::vector<double>> weights) {
  return [weights = std::move(weights)](const Flight&, int i, int j, int) {
    return weights[static_cast<std::size_t>(i - 1)][static_cast<std::size_t>(j - 1)];
  };
}
inline Weight Path() {
  return [](const Flight&, int i, int j, int) { return std::abs(i - j) == 1 ? 1.0 : 0.0; };
}
inline Weight Star() {
  return [](const Flight&, int i, int j, int) { return i != j && (i == 1 || j == 1) ? 1.0 : 0.0; };
}
inline Weight Within(double range_m) {
  return [range_m](const Flight& flight, int i, int j, int tick) {
    return i != j && (flight.at(i, tick).p_WB - flight.at(j, tick).p_WB).norm() < range_m ? 1.0 : 0.0;
  };
}
/// `first` before the tick, `then` from it on.
inline Weight Then(Weight first, int tick, Weight then) {
  return [=](const Flight& flight, int i, int j, int now) { return (now < tick ? first : then)(flight, i, j, now); };
}

/// Consensus as its equation has it: a_i = p_gain sum_j a_ij (p_j - p_i) + v_gain sum_j a_ij (v_j - v_i) - beta v_i.
struct Equation {
  double p_gain = 0.045, v_gain = 0, beta = 0.9;
  double limit = 3.0;  ///< on each axis, m/s^2
  bool wants_z = false;
  Weight weight = Everyone();
  std::function<int(int i, int j)> delay = [](int, int) { return 0; };  ///< ticks until i hears what j says
  int own_delay = 0;                                                    ///< ticks until an agent knows where it is
  std::function<Eigen::Vector3d(int j, int tick)> lie = [](int, int) { return Eigen::Vector3d::Zero().eval(); };
};

inline Eigen::Vector3d Wanted(const Equation& law, const Flight& flight, int i, int tick) {
  const Motion& self = flight.at(i, std::max(0, tick - law.own_delay));
  Eigen::Vector3d a_W = -law.beta * self.v_WB;
  for (int j = 1; j <= flight.agents(); ++j) {
    const int said = tick - law.delay(i, j);
    const double weight = i == j || said < 0 ? 0 : law.weight(flight, i, j, said);
    if (weight == 0) continue;
    const Motion& other = flight.at(j, said);
    a_W += weight * (law.p_gain * (other.p_WB + law.lie(j, said) - self.p_WB) + law.v_gain * (other.v_WB - self.v_WB));
  }
  if (!law.wants_z) a_W.z() = 0;
  return a_W.cwiseMin(law.limit).cwiseMax(-law.limit);
}

/// Checks what is claimed of two flights, before (`was`) and after (`is`) a key is changed.
using Claim = std::function<void(const Flight& was, const Flight& is)>;

inline double FarthestOff(const Equation& law, const Flight& flight, const std::function<bool(int, int)>& counts) {
  double farthest = 0;
  ForAll(flight, [&](int id, int tick) {
    if (!counts(id, tick)) return;
    const double off = (flight.command(id, tick).a_limited_W - Wanted(law, flight, id, tick)).norm();
    farthest = std::max(farthest, off);
  });
  return farthest;
}

inline bool Always(int /*id*/, int /*tick*/) { return true; }
inline std::function<bool(int, int)> AllBut(int agent) {
  return [agent](int id, int) { return id != agent; };
}

/// All commands for which `counts` is true are those of this equation; those of the flight before are not.
inline Claim Obeys(const Equation& law, const std::function<bool(int, int)>& counts = Always) {
  return [=](const Flight& was, const Flight& is) {
    EXPECT_LT(FarthestOff(law, is, counts), 1e-9);
    EXPECT_GT(FarthestOff(law, was, counts), 1e-4) << "without the change, too";
  };
}

// --- the low-level stack ----------------------------------------------------------------------------

/// Tracking of the ideal double integrator by thrust and torques, as agent/controllers/quadrotor.cc has the equations.
struct Stack {
  PdGains altitude, heading, attitude, position;
  double tilt_limit_rad = 0, heading_rad = 0;
  bool exact = false, compensates_drag = true;
};

inline Stack StackOf(const Airframe& airframe) {
  return {airframe.altitude, airframe.heading, airframe.attitude, airframe.position, airframe.tilt_limit_rad};
}

/// Thrust and torques that the stack of an agent commands at each tick.
inline std::vector<Eigen::Vector4d> Commanded(const Stack& stack, const Flight& flight, int id) {
  const Airframe& body = flight.airframe(id);
  const double g = flight.experiment.physics.gravity_m_per_s2, T = flight.T(), m = body.mass_kg;
  const auto pd = [](const PdGains& gains, double error, double rate) { return gains.kp * error + gains.kd * rate; };
  const auto turn = [&](double target, double angle, double rate) {
    const double most = Airframe::kMaxTurnRate * stack.attitude.kd;
    return std::clamp(stack.attitude.kp * (target - angle), -most, most) - stack.attitude.kd * rate;
  };
  Eigen::Vector3d p_ref = flight.at(id, 0).p_WB, v_ref = flight.at(id, 0).v_WB;
  v_ref.z() = 0;
  std::vector<Eigen::Vector4d> commanded;
  for (int tick = 0; tick < flight.ticks(); ++tick) {
    const Motion& self = flight.at(id, tick);
    const Eigen::Vector3d a = flight.command(id, tick).a_limited_W.cwiseProduct(Eigen::Vector3d(1, 1, 0));
    Eigen::Vector3d wanted = a;
    for (int axis = 0; axis < 3; ++axis) {
      const double correction =
          pd(axis < 2 ? stack.position : stack.altitude, p_ref[axis] - self.p_WB[axis], v_ref[axis] - self.v_WB[axis]);
      if (std::abs(correction) <= 1 || axis == 2) {
        wanted[axis] += correction;
      } else {
        p_ref[axis] = self.p_WB[axis];
        v_ref[axis] = self.v_WB[axis];
      }
    }
    if (stack.compensates_drag) wanted += body.linear_drag_kg_per_s / m * self.v_WB;
    p_ref += T * v_ref + T * T / 2 * a;
    v_ref += T * a;

    const Eigen::Matrix3d R = self.q_WB.toRotationMatrix();
    const double roll = std::atan2(R(2, 1), R(2, 2)), pitch = std::asin(-R(2, 0)), yaw = std::atan2(R(1, 0), R(0, 0));
    const double forward = std::cos(yaw) * wanted.x() + std::sin(yaw) * wanted.y();
    const double left = std::cos(yaw) * wanted.y() - std::sin(yaw) * wanted.x(), up = wanted.z() + g;
    double to_roll = stack.exact ? std::atan2(-left, std::hypot(forward, up)) : -left / g;
    double to_pitch = stack.exact ? std::atan2(forward, up) : forward / g;
    to_roll = std::clamp(to_roll, -stack.tilt_limit_rad, stack.tilt_limit_rad);
    to_pitch = std::clamp(to_pitch, -stack.tilt_limit_rad, stack.tilt_limit_rad);
    const double yaw_error = std::remainder(stack.heading_rad - yaw, 2 * std::numbers::pi);
    const Eigen::Vector3d acceleration(turn(to_roll, roll, self.w_WB_B.x()), turn(to_pitch, pitch, self.w_WB_B.y()),
                                       pd(stack.heading, yaw_error, -self.w_WB_B.z()));
    const Eigen::Vector3d torque = body.inertia_kg_m2.cwiseProduct(acceleration);
    commanded.emplace_back(m * up / (stack.exact ? R(2, 2) : 1), torque.x(), torque.y(), torque.z());
  }
  return commanded;
}

/// How far thrust and torques of an agent are from those of a stack, as accelerations (m/s^2, rad/s^2). Ticks at which
/// the rotors cannot give all do not count.
inline double FarthestOff(const Stack& stack, const Flight& flight, int id) {
  const Airframe& body = flight.airframe(id);
  const std::vector<Eigen::Vector4d> commanded = Commanded(stack, flight, id);
  const Eigen::Vector4d scale(1 / body.mass_kg, 1 / body.inertia_kg_m2.x(), 1 / body.inertia_kg_m2.y(),
                              1 / body.inertia_kg_m2.z());
  double farthest = 0;
  for (int tick = 0; tick < flight.ticks(); ++tick) {
    if ((flight.command(id, tick).flags & kRotorLimited) != 0) continue;
    const Eigen::Vector4d off = flight.ThrustAndTorque(id, tick) - commanded[static_cast<std::size_t>(tick)];
    farthest = std::max(farthest, off.cwiseProduct(scale).cwiseAbs().maxCoeff());
  }
  return farthest;
}

/// Thrust and torques of all agents are those of their airframe's stack, changed by `change`; in the flight before they
/// are not. If `agent` is not 0, this holds for that agent alone: the others keep the stack of their airframe.
inline Claim Steers(const std::function<void(Stack&)>& change, int agent = 0) {
  return [=](const Flight& was, const Flight& is) {
    double before = 0;
    for (int id = 1; id <= is.agents(); ++id) {
      Stack stack = StackOf(is.airframe(id));
      const bool is_changed = agent == 0 || id == agent;
      if (is_changed) change(stack);
      EXPECT_LT(FarthestOff(stack, is, id), 1e-6) << "agent " << id;
      if (is_changed) before = std::max(before, FarthestOff(stack, was, id));
    }
    EXPECT_GT(before, 1e-3) << "without the change, too";
  };
}

// --- flights in general -----------------------------------------------------------------------------

/// The flights are the same, bit for bit, before `t_s`, and differ at it.
inline Claim DiffersFrom(double t_s) {
  return [t_s](const Flight& was, const Flight& is) {
    const int from = static_cast<int>(std::lround(t_s / is.T()));
    for (int tick = 0; tick < from; ++tick) ASSERT_EQ(was.Numbers(tick), is.Numbers(tick)) << "tick " << tick;
    EXPECT_NE(was.Numbers(from), is.Numbers(from));
  };
}

inline Claim Both(const Claim& one, const Claim& two) {
  return [=](const Flight& was, const Flight& is) {
    one(was, is);
    two(was, is);
  };
}

using Figure = std::function<double(const Flight&)>;

/// A figure is `value`, within `tolerance`. Before, it was off by more than the tolerance.
inline Claim Becomes(const Figure& figure, double value, double tolerance) {
  return [=](const Flight& was, const Flight& is) {
    EXPECT_NEAR(figure(is), value, tolerance);
    EXPECT_GT(std::abs(figure(was) - value), tolerance) << "without the change, too";
  };
}
/// As above, with a value that depends on the flight after the change.
inline Claim Becomes(const Figure& figure, const Figure& value, double tolerance) {
  return [=](const Flight& was, const Flight& is) { Becomes(figure, value(is), tolerance)(was, is); };
}
/// A figure was `from` and is `to`, both within `tolerance`.
inline Claim Goes(const Figure& figure, double from, double to, double tolerance) {
  return [=](const Flight& was, const Flight& is) {
    EXPECT_NEAR(figure(was), from, tolerance);
    EXPECT_NEAR(figure(is), to, tolerance);
  };
}
/// A figure is more than `times` times as large as before.
inline Claim Grows(const Figure& figure, double times = 1) {
  return [=](const Flight& was, const Flight& is) { EXPECT_GT(figure(is), times * figure(was)); };
}
inline Claim Shrinks(const Figure& figure, double times = 1) {
  return [=](const Flight& was, const Flight& is) { EXPECT_LT(times * figure(is), figure(was)); };
}

}  // namespace mascot::test
