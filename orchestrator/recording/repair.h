#pragma once

#include <cstdint>
#include <string>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/completeness.h"

namespace mascot {

/// Makes a whole recording of the messages that a damaged one holds before its damage: every whole message, with its
/// time.
class Repair {
 public:
  /// Reads through the recording. Throws ConfigError if it is not the recording of a run, and std::runtime_error if it
  /// holds no whole message or has gaps.
  explicit Repair(const std::string& recording);

  /// What is wrong with the recording, and at which byte; empty: it is whole.
  const std::string& damage() const { return contents_.damage; }
  std::uint64_t messages() const { return contents_.messages; }
  /// Where the whole ticks of the recording end (Proof::End).
  std::string End() const { return proof_.End(plan_.ticks); }
  /// Whether nothing is lost: the damage is behind the last message of the run.
  bool keeps_all() const {
    return contents_.data_complete || proof_.ticks == TicksOfEarlyEnd(contents_).value_or(plan_.ticks);
  }

  /// Writes the whole recording to `path`, completely or not at all. If something is lost, its metadata say so
  /// (LossOf); else it has the bytes of the recording before the damage. Throws std::runtime_error.
  void Write(const std::string& path) const;

 private:
  std::string recording_;
  McapContents contents_;
  RecordingPlan plan_;
  Proof proof_;
};

}  // namespace mascot
