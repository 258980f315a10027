#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/lane_numbers.h"

namespace mascot {

/// The numbers of a body in RotorBodies. Vectors take three fields, R (takes B to W) nine, by rows, and the allocation
/// sixteen. SI units; in W where nothing is said.
struct RotorField {
  enum Place : int {
    kP = 0,            // of the body
    kV = 3,            //
    kW = 6,            // turning rate, in W
    kR = 9,            //
    kRotors = 18,      // speeds of the rotors
    kQ = 22,           // R as a quaternion: x, y, z, w; only told
    kWInB = 26,        // the turning rate in B; only told
    kCommand = 29,     // speeds that the rotors are to have
    kRemaining = 33,   // Rotors::Remaining()
    kAllocation = 37,  // Rotors::allocation, by rows
    kMaxRotorSpeed = 53,
    kFollowed,  // Rotors::Followed() in one step
    kDrag,      // Rotors::drag_kg_per_s
    kInverseMass,
    kWeight,        // force of gravity along z: negative
    kInertia = 58,  // principal moments
    kInverseInertia = 61,
    kCount = 64
  };
};

/// One tick of RotorBodies: steps of dt, each with its wind.
struct TickOfRotorBodies {
  double dt_s = 0;
  std::span<const std::array<double, 3>> wind_W;  ///< m/s, by step
};

/// Flies `blocks` blocks of `lanes` bodies through a tick.
struct RotorKernel {
  int lanes;
  void (*fly)(double* numbers, std::size_t blocks, const TickOfRotorBodies& tick);
};
RotorKernel RotorsByDefault();  ///< for every processor
RotorKernel RotorsByAvx();

/// Bodies driven by rotors, which touch nothing and are flown several at once, in the lanes of the processor's vector
/// registers. The bits of the results do not depend on the number of lanes.
class RotorBodies {
 public:
  /// `max_lanes`: not to use more than this, though the processor may have more. The bodies are upright, have moments
  /// of inertia of 1, and else zeros.
  RotorBodies(std::size_t bodies, int max_lanes);

  double& At(std::size_t body, int field) { return numbers_.At(body, field); }
  double At(std::size_t body, int field) const { return numbers_.At(body, field); }
  /// Whether Fly() is to fly this body. At first it is not.
  void SetFlown(std::size_t body, bool is_flown);
  /// How many bodies are computed at once, and how many blocks of so many there are.
  std::size_t lanes() const { return numbers_.lanes(); }
  std::size_t blocks() const { return numbers_.blocks(); }
  /// Flies the bodies of the blocks `first` to `end` - 1 through a tick. The numbers of those that are not to be flown
  /// say nothing afterwards. Threads may call it for other blocks meanwhile.
  void Fly(const TickOfRotorBodies& tick, std::size_t first, std::size_t end);

 private:
  RotorKernel kernel_;
  LaneNumbers numbers_;
  std::vector<char> is_flown_;  // by body
  std::vector<int> flown_;      // by block: how many of its bodies are flown
};

/// The numbers of lanes that this processor can have, the largest first.
std::vector<int> LanesOfRotors();

}  // namespace mascot
