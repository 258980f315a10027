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

/// What a picture of many runs looks like: the options that every verb with such a picture has.
struct PictureFiles {
  std::string format = "png", size = "screen";  ///< scripts/figure_style.py knows what they may be
  bool none = false;

  void SetUp(CLI::App& command);
  /// Prints the names of the pictures of the table at `out`.
  void PrintNames(const std::string& out) const;
};

/// What the command line says about the picture of a sweep.
struct SweepPicture {
  std::optional<std::string> metric;  ///< the column to plot; absent: the user's first, or kUsualMetric
  PictureFiles files;

  void SetUp(CLI::App& command);
  /// Whether the sweep can be plotted: over at most two keys, or over seeds alone. Throws ConfigError if --plot asks
  /// for a plot that is not possible.
  bool IsDrawable(const SweepPlan& plan) const;
  /// Draws the complete table at the path `out` by scripts/plot_sweep.py. Returns its exit code, as RunScript() does.
  int Draw(const std::string& out, const SweepPlan& plan, const SweepIdentity& identity, StopSignal& stop) const;
};

}  // namespace mascot
