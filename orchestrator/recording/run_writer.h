#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "idl/topics.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/kept_row.h"
#include "orchestrator/recording/ros_rows.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/recording/states_npz.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Writes the rows of a run to the recording (run.mcap) and states.npz: of every tick, or as record.rate_hz says, with
/// the last one and all events. Both engines use it, so that equal rows give byte-identical files. Failures throw
/// std::runtime_error.
class RunWriter final : public RowSink {
 public:
  /// `without_events` is the resolved experiment as TOML, without events. It is attached to the recording before the
  /// messages, so that a cut recording has it.
  RunWriter(const Experiment& experiment, const RunFolder& folder, const std::string& without_events);

  void Add(const FlownRow& row) override;
  /// Completes the files. Without it the recording is readable up to its last complete chunk, and there is no
  /// states.npz. `config`: the resolved experiment as TOML, with all events that it has or was given, to be attached.
  void Close(const std::string& config);

  /// Where SceneEdges puts the states of edges, for /scene; null: the recording has no such channel.
  EdgeQueue* edges() { return ros_ && ros_->rows.has_scene() ? &ros_->rows.edges() : nullptr; }

  std::int64_t ticks() const { return ticks_; }  ///< that were added
  std::int64_t rows() const { return rows_; }    ///< that were written
  std::uint64_t samples() const { return mcap_.messages(); }
  std::size_t topics() const { return topics_; }

 private:
  /// Adds the channel of a topic to the recording; nothing if record.topics does not select it.
  std::optional<std::uint16_t> AddChannel(const Topic& topic);
  void WriteRow(const FlownRow& row);
  void WriteEvents(const FlownRow& row);
  void WriteRos(std::optional<std::uint16_t> channel, const Topic& topic, std::uint64_t time_ns);
  void WriteSample(std::optional<std::uint16_t> channel, std::uint64_t time_ns, const Row::Bytes& bytes);

  const Experiment& experiment_;
  McapWriter mcap_;
  std::optional<StatesNpz> npz_;
  std::vector<std::optional<std::uint16_t>> actions_, commands_, messages_, states_;  // channels by id - 1
  std::optional<std::uint16_t> clock_, event_;
  /// The channels of record.ros_types.
  struct Ros {
    explicit Ros(const Experiment& experiment) : rows(experiment) {}
    RosRows rows;
    std::vector<std::optional<std::uint16_t>> odometry;  // channels by id - 1
    std::optional<std::uint16_t> scene, tf;
  };
  std::unique_ptr<Ros> ros_;  // only with record.ros_types
  std::size_t topics_ = 0;
  std::int64_t ticks_ = 0, rows_ = 0;
  StateRow arrays_;
  /// The newest row, if record.rate_hz leaves it out: unless another one follows, it is the last, and is written.
  struct Kept {
    explicit Kept(const Experiment& experiment) : row(experiment.size()), encoder(experiment) {}
    bool has_row = false;
    KeptRow row;
    RowEncoder encoder;
  };
  std::optional<Kept> kept_;  // only with record.rate_hz
};

}  // namespace mascot
