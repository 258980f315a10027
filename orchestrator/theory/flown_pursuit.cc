#include "orchestrator/theory/flown_pursuit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>

#include "orchestrator/team/ideal_team.h"

namespace mascot {

std::optional<std::vector<PursuitMeter::Edge>> FlyPursuit(const Experiment& experiment, double longest_s) {
  const double ticks = std::max(static_cast<double>(experiment.ticks()), longest_s * experiment.control.rate_hz);
  if (!(ticks * experiment.size() <= kMaxFlownAgents)) return std::nullopt;
  IdealTeam team(experiment);
  PursuitMeter meter(experiment);
  meter.Add(team.motions());
  try {
    for (auto left = static_cast<std::int64_t>(std::ceil(ticks)); left > 0; --left) {
      team.Step();
      meter.Add(team.motions());
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return meter.Result();
}

}  // namespace mascot
