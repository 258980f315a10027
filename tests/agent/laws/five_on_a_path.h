#pragma once

#include <string>

#include "tests/support/ideal_network.h"

namespace mascot {

/// Five single integrators on a path that start at (3, -1, 4, 1, -5) along x, whose lambda_2 is 0.381966 and whose
/// lambda_n is 3.618034. `more`: lines from [law] on.
inline std::string Five(int rate_hz, double duration_s, const std::string& more) {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) +
         "\n[physics]\ncollisions = false\n[agents]\ncount = 5\nmodel = 'single_integrator'\n"
         "position_m = [[3, 0, 1], [-1, 0, 1], [4, 0, 1], [1, 0, 1], [-5, 0, 1]]\n[control]\nrate_hz = " +
         std::to_string(rate_hz) + "\n[graph]\ntopology = 'path'\n[law]\n" + more;
}

inline double MeanX(const IdealNetwork& network) {
  double sum = 0;
  for (const Motion& motion : network.motions) sum += motion.p_WB.x();
  return sum / static_cast<double>(network.motions.size());
}

inline double SpreadX(const IdealNetwork& network) {
  double least = network.motions[0].p_WB.x(), most = least;
  for (const Motion& motion : network.motions) {
    least = std::min(least, motion.p_WB.x());
    most = std::max(most, motion.p_WB.x());
  }
  return most - least;
}

}  // namespace mascot
