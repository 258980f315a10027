#pragma once

#include <optional>
#include <string>

#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/table/sweep_identity.h"
#include "system/stop_signal.h"

namespace CLI {
class App;
}

namespace mascot {

/// What the command line says about the picture of a sweep.
struct SweepPicture {
  std::optional<std::string> metric;            ///< the column to plot; absent: the user's first, or kUsualMetric
  std::string format = "png", size = "screen";  ///< scripts/plot_sweep.py knows what they may be
  bool none = false;

  void SetUp(CLI::App& command);
  /// Whether the sweep can be plotted: over at most two keys, or over seeds alone. Throws ConfigError if --plot asks
  /// for a plot that is not possible.
  bool IsDrawable(const SweepPlan& plan) const;
  /// Draws the complete table at the path `out` by scripts/plot_sweep.py. Returns its exit code, as RunScript() does.
  int Draw(const std::string& out, const SweepPlan& plan, const SweepIdentity& identity, StopSignal& stop) const;
  /// Prints the names of the pictures that Draw() made.
  void PrintNames(const std::string& out) const;
};

}  // namespace mascot
