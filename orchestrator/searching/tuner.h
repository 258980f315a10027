#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "orchestrator/searching/optimizer.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/sweeper.h"
#include "system/stop_signal.h"

namespace mascot {

/// How the numbers that a candidate has with several seeds become the one by which it is judged.
enum class OverSeeds { kMean, kMedian, kWorst };
inline constexpr EnumNames<OverSeeds, 3> kOverSeeds({{OverSeeds::kMean, "mean"},
                                                     {OverSeeds::kMedian, "median"},
                                                     {OverSeeds::kWorst, "worst"}});

/// Searches for values of keys with which a figure of the run is smallest or largest: an optimiser proposes candidates,
/// batch by batch, the runs of a batch are flown as those of a sweep, and its table grows by them. The candidates
/// depend on the setting and the figures alone, not on how many processes fly: the same command goes on with an
/// interrupted table, and with a larger budget, as if it had never ended.
class Tuner {
 public:
  struct Setting {
    std::vector<std::string> sets;     ///< as typed: one value for all runs, or the values to choose from
    std::vector<std::string> randoms;  ///< as typed: ranges to choose from
    std::string seeds;                 ///< each candidate is flown with each of these; "": with the seed of the file
    std::string metric;                ///< the column that is judged; "": the first of metric_file
    MetricFile metric_file = {};
    bool maximize = false;
    OverSeeds over_seeds = OverSeeds::kMean;
    std::size_t budget = 0;  ///< candidates; one that is proposed again counts, and is not flown again
    std::size_t batch = 8;   ///< candidates that are proposed before the figures of any of them are known
    std::uint64_t seed = 0;  ///< of the optimiser
  };
  struct Options {
    int jobs = 0;  ///< as Sweeper::Options
    std::string out;
    bool force = false;
    /// Called now and then with the runs in the table, of at most so many, and the best figure so far.
    std::function<void(std::size_t rows, std::size_t of, std::optional<double> best)> watch = {};
  };
  /// A candidate that was flown.
  struct Flown {
    Candidate values;             ///< of keys()
    std::optional<double> value;  ///< nothing: a run failed or has no figure
  };
  struct Outcome {
    std::string column;       ///< what was judged
    std::string optimizer;    ///< its name and version
    std::vector<Flown> rows;  ///< in the order of the table
    std::optional<std::size_t> best;
    bool begins_with_file = false;  ///< the first of the rows has the values of the experiment file
    std::size_t runs_per_row = 1;
    Sweeper::Outcome sweep;  ///< of the last batch
    int signal = 0;          ///< that ended the search early; 0: none
  };

  /// `name` and `text` of the experiment file as Sweeper has them. Throws ConfigError for settings that are mistakes.
  Tuner(std::string name, std::string text, Setting setting);

  /// Throws as Sweeper::Fly() and Optimizer do.
  Outcome Search(const Options& options, StopSignal& stop) const;
  /// The keys whose values are chosen.
  std::vector<std::string> keys() const;
  /// The keys whose logarithms are chosen.
  std::vector<std::string> log_keys() const;
  /// The sweep whose runs are those of the candidates `rows`.
  SweepPlan PlanOf(std::span<const Candidate> rows) const;
  /// What a candidate sets, as options: "--set law.p_gain=0.3".
  std::vector<std::string> OptionsOf(const Candidate& values) const;

 private:
  class Course;

  std::optional<Candidate> InTheFile() const;
  std::string Text(const std::string& optimizer) const;

  std::string name_, text_;
  Setting setting_;
  std::vector<SearchedKey> keys_;
  std::vector<std::string> options_;  // that gave the values of keys_
  SweepPlan::Words fixed_;            // what all candidates have in common
};

/// The one number of a candidate, from those of its runs (nothing: the run failed, or has none): nothing is worse than
/// any number, so that a mean with one of them is nothing.
std::optional<double> Judged(std::vector<std::optional<double>> values, OverSeeds how, bool maximize);

}  // namespace mascot
