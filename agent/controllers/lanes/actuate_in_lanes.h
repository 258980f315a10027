#pragma once

// The low-level stack of quadrotors (agent/controllers/quadrotor.cc), several at once. To be included by sources that
// are compiled for lanes (base/lanes.h).
#include <cmath>
#include <cstddef>
#include <numbers>

#include "agent/controllers/lanes/quadrotor_kernel.h"
#include "base/lanes.h"

namespace mascot {
namespace {  // NOLINT(google-build-namespaces): as in base/lanes.h

using F = StackField;

// Largest correction towards the reference, per axis (m/s^2). A body that would need more has been held or pushed: the
// reference restarts from the body.
constexpr double kMaxCorrection = 1.0;
// Lower limit of cos(tilt) where thrust is divided by it: beyond 60 degrees of tilt, thrust is not raised further.
constexpr double kMinUprightness = 0.5;

struct Tilt {
  Real roll_rad, pitch_rad;
};

/// A wanted acceleration in the heading frame, which is W turned by the body's yaw (m/s^2).
struct HeadingAccel {
  Real forward, left, up;
};

MASCOT_IN_LANES HeadingAccel AlongHeading(const Real (&a_W)[3], Real yaw_rad) {
  const Real c = Cos(yaw_rad), s = Sin(yaw_rad);
  return {c * a_W[0] + s * a_W[1], c * a_W[1] - s * a_W[0], a_W[2]};
}

/// The paper's inversion: sin(angle) = angle, cos(angle) = 1, thrust = weight. `min_up`: what the smallest thrust gives
/// (m/s^2). Where that is more than the weight, for example without gravity, it is what accelerates a tilted body.
MASCOT_IN_LANES Tilt SmallAngleTilt(const HeadingAccel& a, Real gravity, Real min_up) {
  const Real up = Max(gravity, min_up);
  return {-a.left / up, a.forward / up};
}

/// Roll and pitch that point z_B = (cos(roll) sin(pitch), -sin(roll), cos(roll) cos(pitch)) along a + g. `min_up`:
/// smallest vertical component (m/s^2), what the smallest thrust gives.
MASCOT_IN_LANES Tilt ExactTilt(const HeadingAccel& a, Real gravity, Real min_up) {
  const Real up = Max(a.up + gravity, min_up);
  return {Atan2(-a.left, Hypot(a.forward, up)), Atan2(a.forward, up)};
}

MASCOT_IN_LANES Tilt ToTilt(const Block& block, const HeadingAccel& a, Mask is_exact) {
  const Real gravity = block.Get(F::kGravity), min_up = block.Get(F::kMinUp);
  const Tilt small = SmallAngleTilt(a, gravity, min_up);
  if (!AnyOf(is_exact)) return small;
  const Tilt exact = ExactTilt(a, gravity, min_up);
  return {is_exact ? exact.roll_rad : small.roll_rad, is_exact ? exact.pitch_rad : small.pitch_rad};
}

/// What the stack needs of R_WB = Rz(yaw) Ry(pitch) Rx(roll).
struct Attitude {
  Real R20, R21, R22, yaw_rad;
};

MASCOT_IN_LANES Attitude AttitudeOf(const Block& block) {
  const Real x = block.Get(F::kQ), y = block.Get(F::kQ + 1), z = block.Get(F::kQ + 2), w = block.Get(F::kQ + 3);
  const Real tx = 2 * x, ty = 2 * y, tz = 2 * z;
  const Real twx = tx * w, twy = ty * w, twz = tz * w;
  const Real txx = tx * x, txy = ty * x, txz = tz * x, tyy = ty * y, tyz = tz * y, tzz = tz * z;
  const Real R00 = 1 - (tyy + tzz), R10 = txy + twz;
  return {txz - twy, tyz + twx, 1 - (txx + tyy), Atan2(R10, R00)};
}
MASCOT_IN_LANES Real Roll(const Attitude& R) { return Atan2(R.R21, R.R22); }
MASCOT_IN_LANES Real Pitch(const Attitude& R) { return Asin(Clamp(-R.R20, InEach(-1), InEach(1))); }

/// A PD law with the gains at `field`.
MASCOT_IN_LANES Real Pd(const Block& block, int field, Real error, Real error_rate) {
  return block.Get(field) * error + block.Get(field + 1) * error_rate;
}

/// PD law with a limited proportional part, so that the rate towards the target settles at Airframe::kMaxTurnRate at
/// most (without damping there is no such limit).
MASCOT_IN_LANES Real TiltAccel(const Block& block, Real error_rad, Real rate) {
  const Real most = block.Get(F::kMaxTurn);
  return Clamp(block.Get(F::kAttitude) * error_rad, -most, most) - block.Get(F::kAttitude + 1) * rate;
}

/// std::remainder(angle, 2 pi). Nearly always the angle is less than a turn beyond [-pi, pi], where one subtraction is
/// exact.
MASCOT_IN_LANES Real WithinHalfATurn(Real angle) {
  constexpr double kPi = std::numbers::pi, kTurn = 2 * kPi;
  if (AllOf(Abs(angle) < 3 * kPi)) return angle > kPi ? angle - kTurn : angle < -kPi ? angle + kTurn : angle;
  for (std::ptrdiff_t lane = 0; lane < kLanes; ++lane) angle[lane] = __builtin_remainder(angle[lane], kTurn);
  return angle;
}

/// PD correction towards the reference along an axis (m/s^2). On an axis that the law steers, a reference that the body
/// cannot follow restarts from the body.
MASCOT_IN_LANES Real Correction(const Block& block, int axis, Mask is_steered, Real& p_ref, Real& v_ref) {
  const Real p = block.Get(F::kP + axis), v = block.Get(F::kV + axis);
  const Real correction = Pd(block, axis < 2 ? F::kPosition : F::kAltitude, p_ref - p, v_ref - v);
  const Mask restarts = (Abs(correction) > kMaxCorrection) & is_steered;
  p_ref = restarts ? p : p_ref;
  v_ref = restarts ? v : v_ref;
  return restarts ? Real{} : correction;
}

/// Integrates the reference along an axis over one tick with `a` held.
MASCOT_IN_LANES void AdvanceReference(const Block& block, int axis, Real a, Real p_ref, Real v_ref) {
  const Real period = block.Get(F::kPeriod);
  block.Set(F::kPRef + axis, p_ref + (period * v_ref + period * period / 2 * a));
  block.Set(F::kVRef + axis, v_ref + period * a);
}

/// The acceleration that the body is to have along an axis of W.
MASCOT_IN_LANES Real WantedAccel(const Block& block, int axis) {
  const Mask is_steered = axis < 2 ? ~Mask{} : ~(block.Get(F::kHoldsAltitude) > 0);
  const Real ideal = is_steered ? block.Get(F::kWanted + axis) : Real{};
  Real p_ref = block.Get(F::kPRef + axis), v_ref = block.Get(F::kVRef + axis);
  const Real correction = Correction(block, axis, is_steered, p_ref, v_ref);
  AdvanceReference(block, axis, ideal, p_ref, v_ref);
  return ideal + correction + block.Get(F::kDragPerS) * block.Get(F::kV + axis);
}

/// Thrust for the vertical acceleration a_z (N). R22 = cos(roll) cos(pitch) is the part of it that points up, by which
/// the exact inversion divides.
MASCOT_IN_LANES Real Thrust_N(const Block& block, Real a_z, const Attitude& R, Mask is_exact) {
  const Real vertical_n = block.Get(F::kMass) * (a_z + block.Get(F::kGravity));
  return is_exact ? vertical_n / Max(R.R22, InEach(kMinUprightness)) : vertical_n;
}

/// Torque about an axis of B that turns the body to `target` and the wanted yaw (N m). At small tilts the rates of
/// roll, pitch and yaw are those about the body's axes.
MASCOT_IN_LANES void Torque_B(const Block& block, const Tilt& target, const Attitude& R, Real (&tau_B)[3]) {
  const Real yaw_error = WithinHalfATurn(block.Get(F::kHeading) - R.yaw_rad);
  const Real turn[3] = {TiltAccel(block, target.roll_rad - Roll(R), block.Get(F::kWInB)),
                        TiltAccel(block, target.pitch_rad - Pitch(R), block.Get(F::kWInB + 1)),
                        Pd(block, F::kHeadingGains, yaw_error, -block.Get(F::kWInB + 2))};
  for (int axis = 0; axis < 3; ++axis) tau_B[axis] = block.Get(F::kInertia + axis) * turn[axis];
}

/// Adds as much of `share` to `squared`, both squared rotor speeds, as keeps every rotor within its range. Returns
/// where that was not all of it.
MASCOT_IN_LANES Mask AddWhatFits(const Real (&share)[4], Real max_squared, Real (&squared)[4]) {
  Real part = InEach(1);
  for (int i = 0; i < 4; ++i) {
    const Real upwards = (max_squared - squared[i]) / share[i], downwards = squared[i] / -share[i];
    part = share[i] > 0 ? Min(part, upwards) : share[i] < 0 ? Min(part, downwards) : part;
  }
  const Real added = Max(part, Real{});
  for (int i = 0; i < 4; ++i) squared[i] = squared[i] + added * share[i];
  return part < 1;
}

/// Turns thrust (N, along z_B) and torques (N m, about x, y, z of B) into rotor speeds within [0, max]:
/// [w1^2 .. w4^2] = A^-1 [T, tau] (A: Airframe).
///
/// Thrust is kept within the airframe's MinCommandedThrust() and MaxCommandedThrust(). If the rotors cannot give all of
/// the torque, roll and pitch are scaled down together, so that their direction stays; yaw, which a quadrotor needs
/// least, gets what is left.
MASCOT_IN_LANES void Mix(const Block& block, Real thrust_n, const Real (&tau_B)[3]) {
  const Real kept = Clamp(thrust_n, block.Get(F::kMinThrust), block.Get(F::kMaxThrust));
  const Real max_squared = block.Get(F::kMaxSquared);
  Real squared[4], roll_and_pitch[4], yaw[4];
  for (int i = 0; i < 4; ++i) {
    const auto inverse = [&](int k) { return block.Get(F::kMixer + 4 * i + k); };
    squared[i] = inverse(0) * kept;
    roll_and_pitch[i] = inverse(1) * tau_B[0] + inverse(2) * tau_B[1];
    yaw[i] = inverse(3) * tau_B[2];
  }
  Mask is_limited = kept != thrust_n;
  is_limited |= AddWhatFits(roll_and_pitch, max_squared, squared);
  is_limited |= AddWhatFits(yaw, max_squared, squared);
  for (int i = 0; i < 4; ++i) block.Set(F::kRotors + i, Sqrt(Min(Max(squared[i], Real{}), max_squared)));
  block.Set(F::kIsRotorLimited, is_limited ? InEach(1) : Real{});
}

/// Runs the stacks of one block.
MASCOT_IN_LANES void ActuateBlock(const Block& block) {
  const Mask is_exact = block.Get(F::kIsExact) > 0;
  const Real a_W[3] = {WantedAccel(block, 0), WantedAccel(block, 1), WantedAccel(block, 2)};
  const Attitude R = AttitudeOf(block);
  const Tilt wanted = ToTilt(block, AlongHeading(a_W, R.yaw_rad), is_exact);
  const Real limit = block.Get(F::kTiltLimit);
  const Tilt target{Clamp(wanted.roll_rad, -limit, limit), Clamp(wanted.pitch_rad, -limit, limit)};
  const Mask is_cut = (target.roll_rad != wanted.roll_rad) | (target.pitch_rad != wanted.pitch_rad);
  block.Set(F::kIsTiltLimited, is_cut ? InEach(1) : Real{});
  Real tau_B[3];
  Torque_B(block, target, R, tau_B);
  Mix(block, Thrust_N(block, a_W[2], R, is_exact), tau_B);
}

/// Runs the stacks of blocks of quadrotors.
void ActuateBlocks(double* numbers, std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b) ActuateBlock(Block(numbers + b * F::kCount * kLanes));
}

}  // namespace
}  // namespace mascot
