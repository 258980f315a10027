#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "idl/topics.h"
#include "orchestrator/formats/mcap/writer.h"

namespace mascot {

/// What the experiment that is attached to a recording says of it.
struct RecordingPlan {
  std::string name;  ///< of the experiment
  int agents = 0;
  int rate_hz = 0;
  bool realtime = false;
  std::uint64_t ticks = 0;    ///< rows of a run that goes to its end
  std::vector<Topic> topics;  ///< the per-tick topics that record.topics wants in the recording

  /// Whether a recording holds a sample of every tick of this topic. In real time a late agent's last command is held,
  /// so that its commands and messages may be fewer.
  bool HasEveryTick(const Topic& topic) const;
};

/// The metadata of a recording that says which version of the format it is.
inline constexpr const char* kMetadata = "mascot";
inline constexpr const char* kFormatKey = "format";
/// Why this version cannot read a recording: it is of a newer one. Empty: it can. A recording that says no format is of
/// version 1.
std::string TooNew(const McapContents& contents);

/// Reads the plan from the attached config.toml. Throws ConfigError if the recording is of a newer format, if there is
/// no config.toml, or if it is somebody else's; `path` is the recording's name in that message.
RecordingPlan PlanOf(const McapContents& contents, const std::string& path);

/// What a recording proves by its sequence numbers: every channel counts 0 .. n-1, and n is the number of ticks
/// wherever there is a sample of each.
struct Proof {
  /// What is missing where nothing should be, whether or not the file was closed; empty: nothing is.
  std::string gap;
  /// Ticks that are wholly there, from 0 on; nothing if no topic has a sample of every tick.
  std::optional<std::uint64_t> ticks;
};
/// Every topic of the plan must be there. Without a plan it is not known which should be: then only those that are
/// there are compared.
Proof Prove(const McapContents& contents, const std::optional<RecordingPlan>& plan);

}  // namespace mascot
