#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// The smallest distances of two agents so far.
class Separation {
 public:
  /// `axes`: of the agents' laws, by id - 1.
  void Add(std::span<const Motion> motions, std::span<const Axes> axes);
  double in_space_m() const;  ///< infinite: there are no two agents
  /// In the plane for pairs of which one has a law in the plane alone, else in space.
  double along_axes_m() const;

 private:
  /// Where an agent is, and whether its law is in the plane alone.
  struct Place {
    std::size_t agent;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
    bool in_plane = false;
  };
  /// All agents, in order of one coordinate. They are nearly in order from tick to tick.
  struct Line {
    int axis = 0;
    std::vector<Place> places;
  };
  static void Sort(Line& line, int axis, std::span<const Motion> motions, std::span<const Axes> axes);

  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double min_in_space2_ = kNone, min_along_axes2_ = kNone;  // squares, in m^2
  Line along_widest_, along_x_;
};

}  // namespace mascot
