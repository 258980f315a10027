#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/ros_rows.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Compares a run, as it flies, with a recording: message by message, in the order of the recording, topic, sequence
/// number, time and bytes. Holds one tick and one message at a time. For recordings in lockstep.
class Comparison final : public RowSink {
 public:
  /// `plan` is that of the recording (PlanOf), `ticks` are those of which it has rows (TicksIn). `experiment`, which is
  /// flown, must outlive this object.
  Comparison(const std::string& recording, const RecordingPlan& plan, const RecordedTicks& ticks,
             const Experiment& experiment);

  /// As RunWriter::edges().
  EdgeQueue* edges() { return ros_ && ros_->has_scene() ? &ros_->edges() : nullptr; }

  /// Compares the next tick. Throws std::runtime_error at the first difference, which ends the run. Ticks after the end
  /// of the recording are not compared.
  void Add(const FlownRow& row) override;
  /// Notes a difference if the recording goes on. Call it after the last tick of the run.
  void Finish();

  /// The first difference: topic, tick, field, both values. Empty: none.
  const std::string& difference() const { return difference_; }
  /// Number of messages that are equal.
  std::uint64_t messages() const { return messages_; }
  /// Number of whole ticks that are equal, from tick 0 on; of those without a row, their events are.
  std::int64_t ticks() const { return ticks_; }
  /// Number of whole rows that are equal.
  std::int64_t rows() const { return rows_; }

 private:
  /// Compares the topic's sample number `sequence`, from 0 on.
  /// `index`: of the topic in the plan.
  void AddSample(std::size_t index, std::int64_t tick, std::int64_t sequence, const Row::Bytes& flown,
                 bool first_of_tick);
  [[noreturn]] void Differ(const std::string& how);

  McapReader reader_;
  const RecordingPlan plan_;
  const RecordedTicks recorded_;
  std::unique_ptr<RosRows> ros_;    // if the recording has record.ros_types
  std::vector<std::string> names_;  // of its topics
  bool over_ = false;               // the recording has ended, or differs
  std::string difference_;
  std::uint64_t messages_ = 0;
  std::int64_t ticks_ = 0, rows_ = 0;
  std::vector<std::int64_t> sent_;  // samples so far, by index in the topics of the plan
};

}  // namespace mascot
