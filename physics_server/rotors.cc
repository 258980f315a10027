#include "physics_server/rotors.h"

#include <algorithm>
#include <cmath>

namespace mascot {

double Rotors::Followed(double dt_s) const { return time_constant_s > 0 ? -std::expm1(-dt_s / time_constant_s) : 1; }

std::size_t Rotors::FailuresBegun(double t_s) const {
  constexpr double kRounding_s = 1e-9;
  return static_cast<std::size_t>(std::ranges::count_if(
      failures, [t_s](const RotorFailure& failure) { return failure.at_s <= t_s + kRounding_s; }));
}

Eigen::Vector4d Rotors::Remaining(double t_s) const {
  Eigen::Vector4d remaining = Eigen::Vector4d::Ones();
  const std::size_t begun = FailuresBegun(t_s);
  for (std::size_t k = 0; k < begun; ++k) remaining[failures[k].rotor - 1] = failures[k].remaining;
  return remaining;
}

}  // namespace mascot
