#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// The keys of a maneuver: a list of times, lists with an entry for each of them, and how leaders fly it.
inline constexpr std::array kManeuverKeys = {
    key::Numbers("times_s", {0, 1e6}, "when the maneuver is at each of its steps; linear between them; increasing"),
    key::Numbers("turns_deg", {-36000, 36000}, "with times_s: the places turned to the left, one angle for each time"),
    key::Points("stretches", {-1000, 1000},
                "with times_s: the places stretched along x, y and z, before they are turned"),
    key::Numbers("shears", {-1000, 1000}, "with times_s: the places sheared, x by y, after they are stretched"),
    key::Points("shifts_m", {-1e6, 1e6}, "with times_s: the places shifted"),
    key::Number("leader_gain", {0, 1000}, "pull of a leader towards where the maneuver has its place")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
};

/// Affine maps over time: p(t) = A(t) r + b(t).
class Maneuver {
 public:
  /// Reads the keys of kManeuverKeys; without times_s the map is r itself. Mistakes are noted in `section`.
  static Maneuver Read(Section& section);
  /// Where the place `r` (m) is at `t_s`, in W (m).
  Eigen::Vector3d At(double t_s, const Eigen::Vector3d& r) const;
  /// The wanted velocity, in W (m/s), of a leader with the place `r`: in a tick of `period_s` the leader moves as far
  /// as its place does, and is pulled towards it.
  Eigen::Vector3d Velocity_W(double t_s, double period_s, const Eigen::Vector3d& r, const Eigen::Vector3d& p_WB) const;
  double gain_per_s() const { return gain_per_s_; }

 private:
  struct Step {
    double at_s = 0;
    double turn_deg = 0;
    Eigen::Vector3d stretch = Eigen::Vector3d::Ones();
    double shear = 0;
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
  };
  Step StepAt(double t_s) const;

  std::vector<Step> steps_;
  double gain_per_s_ = 0;
};

}  // namespace mascot
