#include "agent/laws/event_triggered/trigger.h"

#include <fmt/format.h>

#include <cmath>

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

bool Trigger::Fires(const TriggerParams& params, const Next& next) {
  if (!params.is_dynamic)
    return std::sqrt(next.squared_error_m2) > params.c0_m + params.c1_m * std::exp(-params.alpha * next.t_s);
  const double eta_m2 = has_eta_ ? eta_m2_ : params.eta0_m2;
  eta_m2_ = eta_m2 - params.period_s * (params.beta * eta_m2 + surplus_m2_per_s_);
  has_eta_ = true;
  const double spared = params.gain * params.sigma / 4 * next.q_m2;
  const double surplus = params.gain * next.degree * next.squared_error_m2 - spared;
  const bool fires = params.theta_s * surplus > eta_m2_;
  surplus_m2_per_s_ = fires ? -spared : surplus;
  return fires;
}

}  // namespace mascot
