#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiment/live_experiment.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Passes the rows of a run, and the experiment as events change it, to the sinks of the run, one sink after the other.
/// Each row is decoded once and encoded at most once.
class RowFeed {
 public:
  /// All arguments must outlive this object.
  RowFeed(const Experiment& experiment, std::vector<RowSink*> sinks);

  /// Adds the next tick as received over DDS. Throws std::runtime_error for bytes that are not valid samples, and what
  /// a sink throws.
  void Add(const Row& bytes);
  /// Adds the next tick of a run in one process. Throws what a sink throws.
  void Add(std::int64_t tick, const DecodedRow& decoded);
  /// Passes on what has happened to a vehicle. Throws what a sink throws.
  void OnVehicle(const VehicleNews& news);

 private:
  void HandOut(const FlownRow& row);

  std::vector<RowSink*> sinks_;
  DecodedRow decoded_;  // newest row received; a command that is missing in the next row keeps its value
  RowEncoder encoder_;
  const Experiment& experiment_;
  std::optional<LiveExperiment>
      live_;                   // absent before the first event: most runs have none, and to read a file is slow
  std::vector<Event> events_;  // of the newest row
};

}  // namespace mascot
