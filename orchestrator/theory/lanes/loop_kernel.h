#pragma once

#include <cstddef>

namespace mascot {

/// The numbers of one quadrotor of LowLevelLoops in LaneNumbers. SI units; in W where nothing is said.
struct LoopField {
  enum Place : int {
    kP = 0,         // vectors take three fields
    kV = 3,         //
    kTilt = 6,      // roll, pitch
    kTiltRate = 8,  //
    kTurning = 10,  // angular acceleration that the rotors give now, about roll and pitch
    kLift = 12,     // thrust that they give now
    kThrust = 13,   // held: thrust that they are to give
    kTurn = 14,     // held: angular acceleration that they are to give
    // What follows stays.
    kR = 16,  // of the heading frame, by rows
    kWind = 25,
    kMass = 28,
    kFollowed,  // share of the way to what is held that the rotors go in a step
    kDragPerS,  // B / m
    kMorePush,  // 1 + LoopError::push
    kMoreTurn,  // 1 + LoopError::turn
    kCount
  };
};

/// Steps of dt, in which what is held stays.
struct StepsOfLoops {
  int steps = 0;
  double dt_s = 0;
  double gravity_m_per_s2 = 0;
};

/// Moves `blocks` blocks of `lanes` quadrotors through these steps.
struct LoopKernel {
  int lanes;
  void (*move)(double* numbers, std::size_t blocks, const StepsOfLoops& steps);
};
LoopKernel LoopsByDefault();  ///< for every processor
LoopKernel LoopsByAvx();

}  // namespace mascot
