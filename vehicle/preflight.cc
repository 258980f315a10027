#include "vehicle/preflight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/yaw.h"
#include "vehicle/frames.h"
#include "vehicle/pilot.h"
#include "vehicle/place_text.h"

namespace mascot {
namespace {

constexpr double kMaxAge_s = 1;

PreflightLine LineOf(const Experiment& experiment, const VehicleSeen& seen) {
  const AgentConfig& agent = experiment.agent(seen.agent);
  const VehicleReport& report = seen.report;
  PreflightLine line{.agent = seen.agent};
  const auto refuse = [&line](std::string why) { line.refusals.push_back(std::move(why)); };
  if (report.release.empty() || !report.motion_L) {
    line.seen = report.release.empty() ? "absent" : report.release + ", without a place";
    refuse(!report.problem.empty()   ? report.problem
           : !report.release.empty() ? "nothing has been heard of where it is"
           : report.motion_L         ? "nothing has been heard of its status"
                                     : "nothing has been heard of it: are its domain and namespace right?");
    return line;
  }
  const PilotRules rules = PilotRulesOf(experiment, seen.agent);
  const Motion motion = rules.frame.ToWorld(*report.motion_L);
  const Eigen::Vector3d& p_W = motion.p_WB;
  line.p_W = p_W;
  line.from_start_m = (p_W - agent.p_W).head<2>().norm();
  line.seen = fmt::format(
      "{}, {:.1f} Hz, {:.2f} s old, at {}, heading {:.2f} rad, {:.2f} m from its start; its frame's origin at {}, "
      "turned by {:.2f} rad; battery {}",
      report.release, seen.rate_hz, seen.age_s, PlaceText(p_W), ToHundredths(YawOf(motion.q_WB)), line.from_start_m,
      PlaceText(rules.frame.p_WL), rules.frame.yaw_WL,
      report.battery ? fmt::format("{:.0f} %", 100 * *report.battery) : "unknown");
  line.refusals = WhyNotToStart(rules, report, p_W);
  if (seen.age_s > kMaxAge_s) refuse(fmt::format("nothing has been heard of where it is for {:.1f} s", seen.age_s));
  if (seen.rate_hz < kLeastRate_hz)
    refuse(fmt::format("it says where it is {:.1f} times a second, and {:g} are wanted", seen.rate_hz, kLeastRate_hz));
  return line;
}

}  // namespace

std::vector<PreflightLine> Preflight(const Experiment& experiment, const std::vector<VehicleSeen>& seen) {
  std::vector<PreflightLine> lines;
  for (const VehicleSeen& one : seen) lines.push_back(LineOf(experiment, one));
  for (PreflightLine& line : lines)
    for (const PreflightLine& other : lines) {
      if (&line == &other || !line.p_W || !other.p_W) continue;
      const double apart_m = (*line.p_W - *other.p_W).head<2>().norm();
      const double wanted_m = (experiment.agent(line.agent).p_W - experiment.agent(other.agent).p_W).head<2>().norm();
      if (apart_m < kMinApart_m)
        line.refusals.push_back(fmt::format("it is where vehicle {} is, {:.2f} m apart", other.agent, apart_m));
      else if (std::abs(apart_m - wanted_m) > 2 * Pilot::kMaxFromStart_m)
        line.refusals.push_back(
            fmt::format("it is {:.2f} m from vehicle {}, and the file says {:.2f} m", apart_m, other.agent, wanted_m));
    }
  return lines;
}

}  // namespace mascot
