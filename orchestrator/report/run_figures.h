#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/report/figures.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// A run that is over, and all that is known of it. What it refers to must outlive it.
struct FlownRun {
  const Experiment& experiment;
  const Prediction& prediction;
  const RunMeter& meter;
  const EngineResult& engine;
  std::string engine_name = {};  ///< "dds" | "inprocess"
  std::size_t topics = 0;        ///< topics recorded
  std::uint64_t samples = 0;     ///< samples recorded
};

/// What a phase of a run has come to.
struct PhaseFigures {
  const PhaseMeter* meter = nullptr;
  const Prediction* prediction = nullptr;
  Aim aim = {};
  std::vector<LawMeasured> laws = {};
  Figures figures = {};  ///< "consensus", "formation", "laws"

  /// The phase as an experiment of its own.
  const Experiment& experiment() const { return meter->experiment(); }
};

/// What a run has come to, beside what theory predicts: computed once, when the run is over. summary.json, the terminal
/// and the tables of sweeps print it. docs/recording.md has the definitions.
class RunFigures {
 public:
  /// The run must outlive this object.
  explicit RunFigures(const FlownRun& run);
  RunFigures(const RunFigures&) = delete;
  RunFigures& operator=(const RunFigures&) = delete;

  const FlownRun& run() const { return run_; }
  /// Rows of the run: one more than ticks, or none.
  std::int64_t rows() const { return rows_; }
  /// The figures of summary.json, without those of earlier phases alone. "exit" and "total_s" have no value yet.
  const Figures& all() const { return all_; }
  /// By phase; at least one. The figures of the last are among all().
  const std::vector<PhaseFigures>& phases() const { return phases_; }

 private:
  const FlownRun& run_;
  std::int64_t rows_ = 0;
  std::vector<PhaseFigures> phases_;
  Figures all_;
};

}  // namespace mascot
