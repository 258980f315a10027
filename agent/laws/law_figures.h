#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// How the predicted value of a figure is related to the measured one.
enum class Bound { kEqual, kAtMost, kAtLeast, kWithin };
inline constexpr EnumNames<Bound, 4> kBounds(
    {{Bound::kEqual, "equal"}, {Bound::kAtMost, "at_most"}, {Bound::kAtLeast, "at_least"}, {Bound::kWithin, "within"}});

/// A figure that a law measures in a run, beyond those that all laws share (orchestrator/measuring/metrics.h), and that
/// theory may predict.
struct LawFigure {
  std::string_view name;       ///< with its unit, as in summary.json: "agreement_time_s"
  std::string_view meaning;    ///< "from which on all agents are within 1 mm"
  std::string_view each = {};  ///< a list, with a value for each of these: "waypoint"; empty: one value
  /// A predicted bound that is not above `least`, or not below `most`, says nothing about the figure: theory is then
  /// silent about it.
  double least = 0, most = std::numeric_limits<double>::infinity();
  std::string_view unpredicted = {};  ///< why theory never predicts it, in words that follow "because"; empty: it may
};

/// What tells, tick by tick, how a law fares: its own curve on the page of a run.
struct LawCurve {
  std::string_view name;         ///< "distance to the evader"
  std::string_view unit;         ///< "m"; empty: a count
  std::string_view meaning;      ///< "of the nearest pursuer"
  bool decays = true;            ///< to 0, so that a logarithmic axis tells most
  std::string_view figure = {};  ///< the LawFigure whose prediction is about these values; empty: none is
};

/// The values of a LawFigure: one, or one for each entry of its list. Absent: there is none, or none yet.
using FigureValues = std::vector<std::optional<double>>;

/// One tick of a run, as the meters of laws get it. Entries are by id - 1.
struct TeamRow {
  std::int64_t tick = 0;
  std::span<const Motion> motions;
  std::span<const Command> commands;
  std::span<const std::vector<double>> messages;  ///< empty: none was sent
};

/// Measures the figures of one law, row by row, over the agents that fly it.
class LawMeter {
 public:
  virtual ~LawMeter() = default;
  /// Call it when events have changed the experiment: from the next row on, the experiment is `now`, which must live
  /// until the next Adopt().
  virtual void Adopt(const Experiment& /*now*/) {}
  virtual void Add(const TeamRow& row) = 0;
  /// The values so far, in the order of LawEntry::figures.
  virtual std::vector<FigureValues> Figures() const = 0;
  /// The value of LawEntry::curve in the newest row; nothing: it has none there, or the law has no curve.
  virtual std::optional<double> Curve() const { return std::nullopt; }
};

/// A figure as theory predicts it.
struct PredictedFigure {
  FigureValues values = {};  ///< empty: theory does not say
  Bound bound = Bound::kEqual;
  /// Why some or all of the values are absent, in words that follow "because".
  std::string why = {};
  /// The magnitude of the numbers from which the figure is computed, in the unit of the figure, if it is larger than
  /// the figure because these numbers cancel (as in a share of a value at the start). For lengths, the magnitude of the
  /// positions is added. Rounding puts the figure off by a share of this magnitude (agent/laws/parts/rounding.h).
  double magnitude = 0;
  /// How far off rounding may put the measured figure; bounds include it. Predict() sets it, laws do not.
  double rounding = 0;
  std::string beside = {};       ///< what else to know about the figure, in a few words: "slowest mode 5.1"
  FigureValues tolerances = {};  ///< for kWithin: the largest distance of the measured values from `values`; else empty
};

/// A figure that theory does not predict, because of `why`.
inline PredictedFigure NotPredicted(std::string why) { return {.why = std::move(why)}; }

/// How fast the modes of a law that wants velocities decay on bodies that take these velocities at once: x' = -rate x.
struct LawRates {
  std::vector<double> per_s;  ///< positive
  std::string_view key;       ///< the gain to which all are proportional: "law.gain"
  double gain = 0;
};

/// The time, since the law began, from which on predictions about the end of a run hold. kEqual: from this time on, and
/// not before; kAtMost: from this time on, or earlier; kAtLeast: not before this time.
struct HoldsFrom {
  double time_s = 0;
  Bound bound = Bound::kEqual;
  /// What is the case if a run ends before, in a few words: "distances are off by up to 1 m".
  std::string until_then = {};
};

/// What theory says about an experiment whose agents all fly one law.
struct LawTheory {
  std::string silent = {};                      ///< why theory says nothing; empty: it speaks
  std::vector<PredictedFigure> figures = {};    ///< in the order of LawEntry::figures; empty if theory is silent
  std::optional<Eigen::Vector3d> value_m = {};  ///< where agents meet, in W
  std::optional<LawRates> rates = {};           ///< the modes, to be judged on bodies that take no velocity at once
  bool unlimited = false;                       ///< the predictions hold only if no limit cuts what the law wants
  /// The predictions are about the agents' messages, wherever their bodies are.
  bool of_messages = false;
  std::optional<HoldsFrom> holds_from = {};  ///< absent: they hold at any time, or theory does not know since when
  std::vector<std::string> warnings = {};    ///< "key: text": what will not work, or will not work as expected
};

}  // namespace mascot
