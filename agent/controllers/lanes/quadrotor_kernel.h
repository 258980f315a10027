#pragma once

#include <cstddef>

namespace mascot {

/// The numbers of one quadrotor's low-level stack in LaneNumbers. SI units; in W where nothing is said. Gains are
/// those of Airframe: proportional, then derivative.
struct StackField {
  enum Place : int {
    kP = 0,                // of the body, as measured; vectors take three fields
    kV = 3,                //
    kQ = 6,                // x, y, z, w
    kWInB = 10,            // its turning rate, in B
    kWanted = 13,          // acceleration that the law wants, limited
    kPRef = 16,            // p*
    kVRef = 19,            // v*
    kRotors = 22,          // told: the speeds of the rotors
    kIsTiltLimited = 26,   // told: 1 or 0
    kIsRotorLimited = 27,  // told: 1 or 0
    // What follows stays.
    kHoldsAltitude = 28,  // 1: law.axes = "xy"
    kIsExact,             // 1: control.inversion = "exact"
    kPeriod,
    kHeading,   // that is wanted
    kDragPerS,  // B / m, 0 if not compensated
    kGravity,
    kMass,
    kTiltLimit,
    kMinUp,  // what the smallest thrust accelerates the body by
    kPosition,
    kAltitude = kPosition + 2,
    kHeadingGains = kAltitude + 2,
    kAttitude = kHeadingGains + 2,
    kMaxTurn = kAttitude + 2,  // largest proportional part of the attitude's PD law
    kInertia,
    kMinThrust = kInertia + 3,
    kMaxThrust,
    kMaxSquared,  // (rad/s)^2
    kMixer,       // A^-1, by rows
    kCount = kMixer + 16
  };
};

/// Runs the stacks in `blocks` blocks of `lanes` quadrotors for one tick.
struct QuadrotorKernel {
  int lanes;
  void (*actuate)(double* numbers, std::size_t blocks);
};
QuadrotorKernel QuadrotorsByDefault();  ///< for every processor
QuadrotorKernel QuadrotorsByAvx();

}  // namespace mascot
