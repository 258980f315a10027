#include "agent/laws/event_triggered/trigger.h"

#include <fmt/format.h>

namespace mascot {

TriggerParams ReadTrigger(const Experiment& experiment, Section& law) {
  const TriggerParams trigger = {.is_dynamic = law.OneOf("trigger") == kTriggers[1],
                                 .gain = law.Number("gain"),
                                 .period_s = experiment.period_s(),
                                 .c0_m = law.Number("c0_m"),
                                 .c1_m = law.Number("c1_m"),
                                 .alpha = law.Number("alpha"),
                                 .sigma = law.Number("sigma"),
                                 .theta_s = law.Number("theta_s"),
                                 .beta = law.Number("beta"),
                                 .eta0_m2 = law.Number("eta0_m2")};
  const double fastest = trigger.beta + 1 / trigger.theta_s;
  if (trigger.is_dynamic && !law.Wrong("beta") && !law.Wrong("theta_s") && trigger.period_s * fastest > 1)
    law.Fail("beta", fmt::format("expected beta + 1 / theta_s at most {} (control.rate_hz), got {:.4g}",
                                 experiment.control.rate_hz, fastest));
  return trigger;
}

}  // namespace mascot
