#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "experiment/experiment.h"

namespace mascot {

/// A loop of an agent's low-level stack that does not decay at the control rate, since it computes once in a control
/// period and holds.
struct UnstableLoop {
  int agent = 0;
  std::string_view name;          ///< "attitude", "altitude", "heading", "position", "velocity"
  std::optional<double> rate_hz;  ///< the control rate that must be exceeded; absent: it decays at none
};

/// The loop of an agent that needs the highest rate; nothing: all loops decay. Errors are taken to be small, so that no
/// limit is reached. A loop without gains does not count, nor does a loop that nothing disturbs.
std::optional<UnstableLoop> FindUnstableLoop(const Experiment& experiment);
/// As a warning: "key: text".
std::string Warning(const UnstableLoop& loop, const Experiment& experiment);

}  // namespace mascot
