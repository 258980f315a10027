#pragma once

namespace mascot {

/// The sign of x: 1, -1, or 0 for x = 0.
inline double Sgn(double x) { return (x > 0) - (x < 0); }

}  // namespace mascot
