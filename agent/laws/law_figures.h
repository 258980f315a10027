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

/// What the predicted value of a figure is to the measured one.
enum class Bound { kEqual, kAtMost, kAtLeast, kWithin };
inline constexpr EnumNames<Bound, 4> kBounds(
    {{Bound::kEqual, "equal"}, {Bound::kAtMost, "at_most"}, {Bound::kAtLeast, "at_least"}, {Bound::kWithin, "within"}});

/// A figure that a law measures in a run, beyond those that all laws share (orchestrator/measuring/metrics.h), and that
/// theory may predict.
struct LawFigure {
  std::string_view name;       ///< with its unit, as in summary.json: "agreement_time_s"
  std::string_view meaning;    ///< "from which on all agents are within 1 mm"
  std::string_view each = {};  ///< a list, with a value for each of these: "waypoint"; empty: one value
  /// A predicted bound that is not above `least`, or not below `most`, says nothing: theory is then silent about the
  /// figure.
  double least = 0, most = std::numeric_limits<double>::infinity();
  std::string_view unpredicted = {};  ///< why theory never predicts it, in words that follow "because"; empty: it may
};

/// The values of a LawFigure: one, or one for each entry of its list. Absent: there is none, or none yet.
using FigureValues = std::vector<std::optional<double>>;

/// One tick of a run as laws measure it. Vectors are by id - 1.
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
  /// Events have changed the experiment: from the next row on it is `now`, which lives until the next Adopt().
  virtual void Adopt(const Experiment& /*now*/) {}
  virtual void Add(const TeamRow& row) = 0;
  /// In the order of LawEntry::figures.
  virtual std::vector<FigureValues> Figures() const = 0;
};

/// A figure as theory predicts it.
struct PredictedFigure {
  FigureValues values = {};  ///< empty: theory does not say
  Bound bound = Bound::kEqual;
  /// Why some or all of the values are absent, in words that follow "because".
  std::string why = {};
  /// The magnitude of the numbers from which the figure is computed, in its unit, where it is larger than the figure
  /// because they cancel, as in a share of what was there at the start. For lengths, that of the positions is added.
  /// Rounding puts the figure off by a share of this magnitude (agent/laws/parts/rounding.h).
  double magnitude = 0;
  /// So much rounding may put the measured figure off. Bounds have it in them. Made by Predict(), not by laws.
  double rounding = 0;
  std::string beside = {};       ///< what else is to be known of it, in a few words: "slowest mode 5.1"
  FigureValues tolerances = {};  ///< of kWithin: how far from `values` the measured ones are at most; else empty
};

/// A figure that theory does not predict, because of `why`.
inline PredictedFigure NotPredicted(std::string why) { return {.why = std::move(why)}; }

/// How fast the modes of a law that wants velocities decay on bodies that have them at once: x' = -rate x.
struct LawRates {
  std::vector<double> per_s;  ///< positive
  std::string_view key;       ///< the gain to which all are proportional: "law.gain"
  double gain = 0;
};

/// The time since the law began from which on holds what theory says of the end of a run: kEqual: from then on and not
/// before; kAtMost: from then on, or sooner; kAtLeast: not yet then.
struct HoldsFrom {
  double time_s = 0;
  Bound bound = Bound::kEqual;
  std::string until_then = {};  ///< what is so if a run ends before, in a few words: "distances are off by up to 1 m"
};

/// What theory says about an experiment whose agents all fly one law.
struct LawTheory {
  std::string silent = {};                      ///< why theory says nothing; empty: it speaks
  std::vector<PredictedFigure> figures = {};    ///< in the order of LawEntry::figures; empty if it is silent
  std::optional<Eigen::Vector3d> value_m = {};  ///< where agents meet, in W
  std::optional<LawRates> rates = {};           ///< to be judged on bodies that have no velocity at once
  bool unlimited = false;                       ///< all this holds only where no limit cuts what the law asks for
  bool of_messages = false;                     ///< it is of what agents say, wherever their bodies are
  std::optional<HoldsFrom> holds_from = {};     ///< absent: at any time, or theory does not know
  std::vector<std::string> warnings = {};       ///< "key: text": what will not work, or not as expected
};

}  // namespace mascot
