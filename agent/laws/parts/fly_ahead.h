#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

/// A law that moves a team of single integrators towards a shape. Vectors are by id - 1, in W.
struct ShapeLaw {
  std::function<std::vector<Eigen::Vector3d>(std::span<const Eigen::Vector3d> p_W)> velocities_W;
  std::function<double(std::span<const Eigen::Vector3d> p_W)> error;  ///< how far the team is from the shape
  double settled = 0;                                                 ///< an error at which it has the shape
};

/// Finds the tick from which on the error is small for good.
class SettlingMeter {
 public:
  explicit SettlingMeter(double settled) : settled_(settled) {}
  void Add(std::int64_t tick, double error) {
    if (!(error <= settled_))
      from_.reset();
    else if (!from_)
      from_ = tick;
  }
  /// The tick from which on the error has been small; absent: it is not small now.
  std::optional<std::int64_t> from() const { return from_; }

 private:
  double settled_;
  std::optional<std::int64_t> from_;
};

/// A team that was flown without bodies: p+ = p + T v, from the start to the end of the run.
struct FlownAhead {
  std::string silent = {};  ///< why the flight says nothing about the run; empty: it does
  /// The law moves no agent from the start, though it would from a start beside it.
  bool rests_at_start = false;
  std::vector<Eigen::Vector3d> p_W = {};  ///< at the end
  double error = 0;                       ///< at the end
  std::optional<double> settled_s = {};   ///< from when on it has the shape
  // These two are set only if the team has no shape by the end of the run, and is flown on.
  std::optional<double> later_s = {};  ///< time from which on the team has the shape; absent: not soon
  /// Where the team comes to rest without the shape; empty: it does not, or not soon.
  std::vector<Eigen::Vector3d> rest_W = {};
};

/// Flies two teams: that of the experiment, and one whose start is disturbed by 1e-9 of the team's size. If they end
/// more than 1e-5 of this size apart, rounding may decide where a run ends, and the flight says nothing. It says
/// nothing either if a limit cuts a velocity, if bodies touch that can, if the team flies away, or if the run is more
/// than 5e6 steps of an edge, or of a pair of bodies. If the team does not have the shape at the end of the run, it
/// flies on, for up to ten times as long in all.
FlownAhead FlyAhead(const Experiment& experiment, const ShapeLaw& law);
/// The time from which on the team has the shape. `still_off` says what is the case if the run ends before.
std::optional<HoldsFrom> WhenShaped(const Experiment& experiment, const FlownAhead& ahead, std::string still_off);

}  // namespace mascot
