#pragma once

#include <optional>

#include "experiment/experiment.h"

namespace mascot {

/// The tension of an edge between two agents that hear each other within a range D (Ji & Egerstedt 2007): its potential
/// is gain l^2 / (D - l), which grows beyond all bounds as the distance l comes close to D.
struct Tension {
  double gain = 0;      ///< m/s
  double range_m = 0;   ///< D
  double margin_m = 0;  ///< closer than D - margin_m, an agent begins to count

  /// Whether an agent at distance `l` (m) counts; `already`: it has so far.
  bool Counts(double l, bool already) const { return l < (already ? range_m : range_m - margin_m); }
  /// The pull of an edge of length `l` (m), per length (1/s).
  double Stiffness(double l) const { return gain * (2 * range_m - l) / ((range_m - l) * (range_m - l)); }
};

/// The edges that count at the start, each weighted by its stiffness (1/s).
Graph StiffnessAtStart(const Experiment& experiment, const Tension& tension);
/// Whether single integrators, whose velocities are held for a tick, keep every edge that has begun to count. They are
/// flown from their starts until they are so near each other that none can be lost any more, or the run ends. Nullopt:
/// there are too many of them, or of ticks.
std::optional<bool> KeepsEveryEdge(const Experiment& experiment, const Tension& tension);

}  // namespace mascot
