#pragma once

#include <optional>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/scene_edges.h"
#include "orchestrator/measuring/incident_meter.h"
#include "orchestrator/measuring/law_curve.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/recording/background_sink.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/run_writer.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// What a run leaves in its folder, but for summary.json, logs and pictures: config.toml, the recording, states.npz,
/// events.csv, law_curve.csv. Failures throw std::runtime_error.
class RunFiles {
 public:
  /// Writes config.toml and begins the recording. All arguments must outlive this object; the run must have no row yet.
  RunFiles(const Experiment& experiment, const RunFolder& folder, RunMeter& meter);

  /// Adds the sinks that write and measure the run, the meter among them. They must be the first of all sinks.
  void AddTo(std::vector<RowSink*>& sinks);
  /// Completes the recording when the run is over, with config.toml: that of what was flown. `by_hand`: the events that
  /// the run was given. Returns the experiment with these events.
  Experiment Complete(std::vector<Event> by_hand, const EngineResult& result);
  /// Writes the tables, after Complete().
  void WriteTables(const Incidents& incidents) const;

  std::size_t topics() const { return writer_.topics(); }      ///< that are recorded
  std::uint64_t samples() const { return writer_.samples(); }  ///< that were written
  /// Whether the run has moved: it has more than its start. After Complete().
  bool has_moved() const { return writer_.rows() > 1; }

 private:
  const Experiment& experiment_;
  const RunFolder& folder_;
  RunMeter& meter_;
  RunWriter writer_;
  BackgroundSink writes_;
  std::optional<SceneEdges> edges_;  // only if the recording has a /scene
  LawCurveRecord curve_;
};

}  // namespace mascot
