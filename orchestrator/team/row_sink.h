#pragma once

#include <cstdint>
#include <span>

#include "base/flight_phase.h"
#include "experiment/live_experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// One tick of a run, as an engine passes it to its sinks.
class FlownRow {
 public:
  virtual ~FlownRow() = default;
  virtual std::int64_t tick() const = 0;
  virtual const DecodedRow& decoded() const = 0;
  /// The samples as sent over DDS; for a run in one process, as they would have been sent. Encoded at the first call.
  virtual const Row& bytes() const = 0;
  /// bytes(), if they were sent over DDS; null for a run in one process.
  virtual const Row* received() const = 0;
};

/// Receives every row of a run, in tick order: the writer of the run's files, the meters, the progress line.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// Called when `events`, those of the next row, have changed the experiment: from that row on, the experiment is
  /// `live.now()`, which lives as long as the sink keeps it. `live` itself changes with further events.
  virtual void Adopt(const LiveExperiment& /*live*/, std::span<const Event> /*events*/) {}
  /// Takes the next row, which is valid during the call. If this throws, the run fails.
  virtual void Add(const FlownRow& row) = 0;
  /// Something has happened to a vehicle since the newest row; before the first row, too.
  virtual void OnVehicle(const VehicleNews& /*news*/) {}
};

}  // namespace mascot
