#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "idl/topics.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/recorded_ticks.h"

namespace mascot {

/// What a recording should contain, according to the experiment attached to it.
struct RecordingPlan {
  std::string name;  ///< run.name
  int agents = 0;
  int rate_hz = 0;
  bool realtime = false;
  std::uint64_t ticks = 0;    ///< ticks of a complete run
  int ticks_per_row = 1;      ///< from one row to the next (record.rate_hz)
  std::vector<Topic> topics;  ///< the recorded topics that record.topics selects
  bool ros_types = false;     ///< among them may be those in standard types of ROS 2 (record.ros_types)
  std::set<int> lost = {};    ///< agents that are lost for some time (events)

  /// Whether the topic has a sample in every row. In real time, agents may miss ticks, and those that are lost answer
  /// none: their last command is held, and commands and messages may be fewer.
  bool IsInEveryRow(const Topic& topic) const;
};

/// The metadata of a recording that says which version of the format it is.
inline constexpr const char* kMetadata = "mascot";
inline constexpr const char* kFormatKey = "format";
/// Why this program cannot read a recording: its format is newer. Empty: it can. A recording without a format has
/// version 1.
std::string TooNew(const McapContents& contents);

/// Attachments: the resolved experiment with all events that it has or was given; the same without any event, written
/// before the first message.
inline constexpr const char* kConfigFile = "config.toml";
inline constexpr const char* kExperimentFile = "experiment.toml";
inline constexpr const char* kToml = "application/toml";

/// In that metadata, the key of the damage of the file from which the recording was recovered.
inline constexpr const char* kRecoveredKey = "recovered";
/// Why ticks may be missing at the end: the damage of the file, or of the file from which it was recovered. Empty: none
/// is missing there.
std::string LossOf(const McapContents& contents);

/// Reads the plan from the attached config.toml. Throws ConfigError if the recording is of a newer format, if there is
/// no config.toml, or if that is not a MASCOT experiment; `path` names the recording in that message.
RecordingPlan PlanOf(const McapContents& contents, const std::string& path);

/// The metadata of a recording whose run ended early: how many ticks it holds.
inline constexpr const char* kEarlyEnd = "mascot_ended_early";
inline constexpr const char* kTicksKey = "ticks";
/// How many ticks a run that ended early says it has recorded; nothing if it does not say that it ended early.
std::optional<std::uint64_t> TicksOfEarlyEnd(const McapContents& contents);
/// Number of ticks up to the last of which the recording has a message; at most those of the plan. Its times must be
/// known (ReadMcap).
std::uint64_t TicksBegun(const McapContents& contents, const RecordingPlan& plan);
/// The ticks of which the recording has rows, up to the end of its run; of a recording with losses, up to the
/// end of the plan, unless it has the last row of a run that ended early.
RecordedTicks TicksIn(const McapContents& contents, const RecordingPlan& plan);

/// Result of checking a recording by its sequence numbers and counts: each channel counts 0 .. n-1, where n is the
/// number of rows for every topic with a sample in every row.
struct Proof {
  /// Description of the first gap: something is missing that should be there even if the file was not closed, or the
  /// run ended early. Empty: none.
  std::string gap;
  /// Number of complete rows; nothing if the plan has no topic with a sample in every row.
  std::optional<std::uint64_t> rows;
  /// Number of ticks up to the last complete row.
  std::optional<std::uint64_t> ticks;
  /// Where the whole ticks end: "whole up to tick 812 of 4000", "no tick is whole". Empty without `ticks`.
  std::string End(std::optional<std::uint64_t> planned_ticks) const;
};
/// Checks a recording, of which only the topics of the plan count. Each of them must be there.
Proof Prove(const McapContents& contents, const RecordingPlan& plan);

/// Whether a recording is complete: it was closed, it has no gap, the experiment attached to it says which topics and
/// how many ticks there must be (fewer only if the run says that it ended early), and each message has the time of its
/// tick.
struct Verdict {
  std::optional<RecordingPlan> plan;   ///< absent: no experiment is attached
  std::string reason;                  ///< why it is not complete; empty: it is
  std::optional<std::uint64_t> ticks;  ///< number of ticks; absent: it is not complete
};
/// Judges a recording of which `contents` was read. Reads its times again, from `path`: throws std::runtime_error if it
/// cannot.
Verdict Judge(const std::string& path, const McapContents& contents);

}  // namespace mascot
