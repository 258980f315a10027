#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "vehicle/autopilot.h"

namespace mascot {

/// What has been heard of an agent's vehicle before a flight, by nobody who commands it.
struct VehicleSeen {
  int agent = 0;
  VehicleReport report = {};  ///< the newest
  double rate_hz = 0;         ///< of its motions
  double age_s = 0;           ///< of the newest
};

/// What is said of a vehicle before a flight.
struct PreflightLine {
  int agent = 0;
  std::string seen = {};                    ///< "PX4 1.18, 99.8 Hz, 0.01 s old, at [0.02, 4.01, 0.00], ..."
  std::optional<Eigen::Vector3d> p_W = {};  ///< where it is (m)
  double from_start_m = 0;                  ///< from its agent's start, in the plane
  std::vector<std::string> refusals = {};   ///< why it may not fly; empty: it may
};

/// The lines of all vehicles, in the order of `seen`. Refused are: a vehicle that is absent, old or has a problem; one
/// that is armed; a battery below Pilot::kBatteryToStart; one farther than Pilot::kMaxFromStart_m from its agent's
/// start, or outside of its fence; two at one place, and two whose distance is not that of the starts.
std::vector<PreflightLine> Preflight(const Experiment& experiment, const std::vector<VehicleSeen>& seen);
inline constexpr double kMinApart_m = 0.3, kLeastRate_hz = 5;

}  // namespace mascot
