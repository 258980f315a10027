#pragma once

#include <array>
#include <string_view>

#include "experiment/experiment.h"

namespace mascot {

/// Why a dynamic trigger has no bound.
inline constexpr const char* kOfStatic = "the bound is of the static trigger";

inline constexpr std::string_view kTriggers[] = {"static", "dynamic"};

inline constexpr auto kTriggerKeys = std::array{
    key::OneOf("trigger", kTriggers, "static: a threshold over time; dynamic: one with a memory").Default("\"static\""),
    key::Number("c0_m", {0, 1000}, "static: the threshold in the end").Default("0.02").Live(),
    key::Number("c1_m", {0, 1000}, "static: what the threshold is more at the start").Default("0.2").Live(),
    key::Number("alpha", {0, 1000}, "static: how fast that decays; below gain lambda_2, few messages are sent")
        .Default("0.3")
        .Unit("1/s")
        .Live(),
    key::Number("sigma", {0, 0.99}, "dynamic: how much of the disagreement heard may be the agent's error")
        .Default("0.5")
        .Live(),
    key::Number("theta_s", Above(0, 1000), "dynamic: how soon the memory is used up").Default("1.0").Live(),
    key::Number("beta", Above(0, 1000), "dynamic: how fast the memory decays").Default("0.5").Unit("1/s").Live(),
    key::Number("eta0_m2", Above(0, 1e6), "dynamic: the memory at the start").Default("0.1"),
};

/// When an agent says again where it is. It compares that with what it said last.
struct TriggerParams {
  bool is_dynamic = false;
  double gain = 0;      ///< 1/s: that of the law
  double period_s = 0;  ///< the control period h
  // Static: |e| > c0 + c1 exp(-alpha t)
  double c0_m = 0, c1_m = 0, alpha = 0;
  // Dynamic: theta gain (d |e|^2 - sigma / 4 q) > eta
  double sigma = 0, theta_s = 0, beta = 0, eta0_m2 = 0;
};

/// Reads the keys above, and law.gain.
TriggerParams ReadTrigger(const Experiment& experiment, Section& law);

/// Static: the threshold of Seyboth, Dimarogonas & Johansson, Automatica 49 (2013). Dynamic: Girard, IEEE Trans.
/// Automatic Control 60 (2015), for a network as in Yi, Liu, Dimarogonas & Johansson, ibid. 64 (2019), with delta = 1:
/// an internal variable eta saves up what the agent was closer than it had to be,
///   d eta / dt = -beta eta - gain (d |e|^2 - sigma / 4 q)
/// with the degree d = sum_j a_ij, and q = sum_j a_ij |x_j - x_i|^2 / 2 of what i and j said last. Sampled, eta stays
/// positive if h (beta + 1 / theta) <= 1.
class Trigger {
 public:
  /// What the agent will have at its next tick, at `t_s`, if it says nothing: the error of what it said last (m^2). The
  /// degree and q (m^2) are of this tick.
  struct Next {
    double t_s = 0, squared_error_m2 = 0, degree = 0, q_m2 = 0;
  };

  /// True if the agent is to say at this tick where it will be. To be called once a tick.
  bool Fires(const TriggerParams& params, const Next& next);

 private:
  bool has_eta_ = false;
  double eta_m2_ = 0;
  double surplus_m2_per_s_ = 0;  // gain (d |e|^2 - sigma / 4 q) of the last call
};

}  // namespace mascot
