#pragma once

#include <optional>

namespace mascot {

// One axis of one edge of min-max time consensus (orchestrator/theory/minmax_time.h), if every change of the child's
// acceleration comes `lag_s` late, and the parent does not accelerate. docs/theory.md says what is assumed.

/// The largest distance (m) of the child from the parent in the end. The law is a relay, and with a lag the child
/// overshoots for ever: it trembles around the parent.
double TrembleRadius(double alpha, double beta, double lag_s);
/// Time (s) from which on the child stays within `within_m` of the parent; nothing if that would take too many steps to
/// compute, or never comes.
std::optional<double> LaggedMinmaxTime(double z_m, double w_m_per_s, double alpha, double beta, double lag_s,
                                       double within_m);

}  // namespace mascot
