#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "idl/topics.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/recording/states_npz.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Writes a run's rows: run.mcap and states.npz. Both engines end here, so their files are the same bytes. Failures
/// throw std::runtime_error.
class RunWriter final : public RowSink {
 public:
  /// `resolved` is the resolved experiment, attached to the recording.
  RunWriter(const Experiment& experiment, const RunFolder& folder, const std::string& resolved);

  void Add(const FlownRow& row) override;
  /// Completes the files. Without it they are left readable up to the last whole chunk.
  void Close();

  std::int64_t rows() const { return rows_; }
  std::uint64_t samples() const { return mcap_.messages(); }
  std::size_t topics() const { return topics_; }

 private:
  /// The recording's channel of a topic; nothing if record.topics leaves it out.
  std::optional<std::uint16_t> AddChannel(const Topic& topic);
  void WriteSample(std::optional<std::uint16_t> channel, std::uint64_t time_ns, const Row::Bytes& bytes);

  const Experiment& experiment_;
  McapWriter mcap_;
  std::optional<StatesNpz> npz_;
  std::vector<std::optional<std::uint16_t>> commands_, messages_, states_;  // channels by id - 1
  std::optional<std::uint16_t> clock_;
  std::size_t topics_ = 0;
  std::int64_t rows_ = 0;
  StateRow arrays_;
};

}  // namespace mascot
