#include "orchestrator/theory/delays_in_effect.h"

#include <algorithm>

#include "base/ticks.h"

namespace mascot {

std::vector<DelayInEffect> DelaysInEffect(const Experiment& experiment) {
  std::vector<DelayInEffect> delays;
  const auto add = [&](const char* key, double asked_s, double jitter_s) {
    const auto ticks = [&](double time_s) { return TicksRoundedUp(time_s, experiment.control.rate_hz); };
    const DelayInEffect delay{key, asked_s, jitter_s, ticks(asked_s - jitter_s), ticks(asked_s + jitter_s)};
    if (asked_s > 0 && std::ranges::find(delays, delay) == delays.end()) delays.push_back(delay);
  };
  for (int id = 1; id <= experiment.size(); ++id)
    for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id)) {
      const LinkConfig& link = experiment.links.Of(id, heard.id);
      add("link.delay_s", link.delay_s, link.jitter_s);
    }
  add("sensors.own.delay_s", experiment.sensors.own_delay_s, 0);
  return delays;
}

}  // namespace mascot
