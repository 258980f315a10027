#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <optional>
#include <string_view>
#include <vector>

#include "agent/laws/trajectory/path_samples.h"
#include "experiment/toml/section.h"

namespace mascot {

/// A way that is flown over time: a sum of oscillations about a centre, or samples.
struct ReferencePath {
  /// The part Re(size_W e^(j w t)) of the position.
  struct Oscillation {
    double w = 0;  ///< rad/s
    Eigen::Vector3cd size_W;
  };

  /// A circle, flown counterclockwise from its eastern point.
  static ReferencePath Circle(const Eigen::Vector3d& centre_W, double radius_m, double period_s);
  /// The lemniscate of Gerono, (r sin wt, r sin wt cos wt), from its crossing to the north-east.
  static ReferencePath FigureEight(const Eigen::Vector3d& centre_W, double radius_m, double period_s);
  PathPoint At(double t_s) const;

  Eigen::Vector3d centre_W = Eigen::Vector3d::Zero();
  double period_s = 0;  ///< for samples: time from the first to the last
  std::vector<Oscillation> oscillations = {};
  std::optional<PathSamples> samples = {};  ///< in place of all oscillations
};

inline constexpr std::string_view kPathNames[] = {"circle", "figure_eight", "samples"};

/// The keys of a path, in laws that follow one.
inline constexpr std::array kPathKeys = {
    key::OneOf("path", kPathNames, "what is flown").Default("\"circle\""),
    key::Vector3("centre_m", {-1e6, 1e6}, "of the circle; where a figure eight crosses itself")
        .Default("[0.0, 0.0, 1.0]"),
    key::Number("radius_m", Above(0, 1e6), "of the circle; half the length, from west to east, of a figure eight")
        .Default("2.0"),
    key::Number("period_s", Above(0, 1e6), "time for one circle or figure eight").Default("20.0"),
    key::Text("samples", "with path = \"samples\": lines t,x,y,z (s, m); a cubic spline, at rest at both ends"),
    key::Text("file", "a file that holds the samples, instead of samples; its path from the folder of this file"),
};

/// Reads the keys of kPathKeys. Mistakes are noted in `law`.
ReferencePath ReadPath(Section& law);

}  // namespace mascot
