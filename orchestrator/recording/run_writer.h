#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "idl/topics.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/recording/decoded_row.h"
#include "orchestrator/recording/row.h"
#include "orchestrator/recording/row_encoder.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/recording/states_npz.h"

namespace mascot {

/// Writes a run's rows, in order of tick: run.mcap, states.npz, and what is measured on the way. Both
/// engines end here, so their files are the same bytes. Failures throw std::runtime_error.
class RunWriter {
 public:
  /// `resolved` is the resolved experiment, attached to the recording.
  RunWriter(Experiment& experiment, const RunFolder& folder, const std::string& resolved);

  /// The next tick, as it was on the wire. A command that was not sent is written as held: the one before (zero at
  /// first).
  void Add(const Row& row);
  /// The next tick, as it was flown in one process.
  void Add(std::int64_t tick, const DecodedRow& decoded);
  /// Completes the files. Without it they are left readable up to the last whole chunk.
  void Close();

  std::int64_t rows() const { return rows_; }
  std::uint64_t samples() const { return mcap_.messages(); }
  std::size_t topics() const { return topics_; }
  const RunMeter& meter() const { return meter_; }

 private:
  /// The recording's channel of a topic; nothing if record.topics leaves it out.
  std::optional<std::uint16_t> AddChannel(const Topic& topic);
  void Write(const Row& row, const DecodedRow& decoded);
  void WriteSample(std::optional<std::uint16_t> channel, std::uint64_t time_ns, const Row::Bytes& bytes);

  const Experiment& experiment_;
  McapWriter mcap_;
  std::optional<StatesNpz> npz_;
  RunMeter meter_;
  std::vector<std::optional<std::uint16_t>> commands_, messages_, states_;  // channels by id - 1
  std::optional<std::uint16_t> clock_;
  std::size_t topics_ = 0;
  std::int64_t rows_ = 0;
  DecodedRow decoded_;
  RowEncoder encoder_;
  StateRow arrays_;
};

}  // namespace mascot
