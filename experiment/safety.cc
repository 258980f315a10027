#include "experiment/safety.h"

namespace mascot {

std::span<const Key> SafetyKeys() {
  static constexpr Key kKeys[] = {
      key::Number("distance_m", Above(0, 1e6),
                  "the distance along `law.axes` at which the filter keeps the centres of agents that hear each other")
          .Otherwise("required; in an agent's own law the team's")
          .Live(),
      key::Number("gamma", Above(0, 1000), "how fast agents may use up what is left of the distance: h' >= -gamma h")
          .Default("1.0")
          .Unit("1/s")
          .Live(),
  };
  return kKeys;
}

SafetyConfig ReadSafety(Section& safety) {
  SafetyConfig config;
  config.gamma = safety.Number("gamma");
  if (safety.Has("gamma") && !safety.Has("distance_m"))  // an event may have set it, where there was no filter
    safety.Fail("gamma", "expected distance_m with it, got none");
  else
    config.distance_m = safety.Number("distance_m");
  safety.Done();
  return config;
}

}  // namespace mascot
