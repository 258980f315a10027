#pragma once

// How quadrotors of LowLevelLoops move, several at once. To be included by sources that are compiled for lanes
// (base/lanes.h).
#include <cstddef>

#include "base/lanes.h"
#include "orchestrator/theory/lanes/loop_kernel.h"

namespace mascot {
namespace {  // NOLINT(google-build-namespaces): as in base/lanes.h

using F = LoopField;

/// The rotors follow what is held; thrust and drag move the body, torques turn it. With z_B = (cos(roll) sin(pitch),
/// -sin(roll), cos(roll) cos(pitch)) in the heading frame.
MASCOT_IN_LANES void MoveBlock(const Block& block, const StepsOfLoops& steps) {
  Real p[3], v[3], R[3][3], wind[3], tilt[2], tilt_rate[2], turning[2], turn[2];
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) R[k][i] = block.Get(F::kR + 3 * k + i);
    p[k] = block.Get(F::kP + k);
    v[k] = block.Get(F::kV + k);
    wind[k] = block.Get(F::kWind + k);
  }
  for (int k = 0; k < 2; ++k) {
    tilt[k] = block.Get(F::kTilt + k);
    tilt_rate[k] = block.Get(F::kTiltRate + k);
    turning[k] = block.Get(F::kTurning + k);
    turn[k] = block.Get(F::kTurn + k);
  }
  Real lift = block.Get(F::kLift);
  const Real thrust = block.Get(F::kThrust), mass = block.Get(F::kMass), followed = block.Get(F::kFollowed),
             drag_per_s = block.Get(F::kDragPerS), more_push = block.Get(F::kMorePush),
             more_turn = block.Get(F::kMoreTurn);
  const double dt = steps.dt_s;
  for (int step = 0; step < steps.steps; ++step) {
    lift = lift + followed * (thrust - lift);
    for (int k = 0; k < 2; ++k) turning[k] = turning[k] + followed * (turn[k] - turning[k]);
    const Real sin_roll = Sin(tilt[0]), cos_roll = Cos(tilt[0]), sin_pitch = Sin(tilt[1]), cos_pitch = Cos(tilt[1]);
    const Real up[3] = {more_push * cos_roll * sin_pitch, -more_push * sin_roll, cos_roll * cos_pitch};
    const Real push = lift / mass;
    for (int k = 0; k < 3; ++k) {
      const Real up_W = R[k][0] * up[0] + R[k][1] * up[1] + R[k][2] * up[2];
      Real a = push * up_W - drag_per_s * (v[k] - wind[k]);
      if (k == 2) a = a - steps.gravity_m_per_s2;
      p[k] = p[k] + (dt * v[k] + dt * dt / 2 * a);
      v[k] = v[k] + dt * a;
    }
    for (int k = 0; k < 2; ++k) {
      tilt_rate[k] = tilt_rate[k] + dt * more_turn * turning[k];
      tilt[k] = tilt[k] + dt * tilt_rate[k];
    }
  }
  for (int k = 0; k < 3; ++k) {
    block.Set(F::kP + k, p[k]);
    block.Set(F::kV + k, v[k]);
  }
  for (int k = 0; k < 2; ++k) {
    block.Set(F::kTilt + k, tilt[k]);
    block.Set(F::kTiltRate + k, tilt_rate[k]);
    block.Set(F::kTurning + k, turning[k]);
  }
  block.Set(F::kLift, lift);
}

/// Moves blocks of quadrotors.
void MoveBlocks(double* numbers, std::size_t blocks, const StepsOfLoops& steps) {
  for (std::size_t b = 0; b < blocks; ++b) MoveBlock(Block(numbers + b * F::kCount * kLanes), steps);
}

}  // namespace
}  // namespace mascot
