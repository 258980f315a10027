#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/contacts.h"
#include "base/pacing.h"
#include "experiment/events.h"

namespace mascot {

/// The names of the engines, for --engine and summary.json.
inline constexpr const char* kOverDds = "dds";
inline constexpr const char* kInProcess = "inprocess";

/// Result of a run; the same for both engines.
struct EngineResult {
  std::string failure;  ///< why the run failed; empty: it ran to its end, or was stopped in order
  /// Losses of agents that have not answered the tick of the last row (Fault::unanswered): events of the next tick,
  /// which was not flown. Without those of the file.
  std::vector<Event> unanswered;
  int signal = 0;                    ///< the signal that stopped the run early; 0: none
  double wall_s = 0;                 ///< wall-clock time from tick 0 to the last command
  double startup_s = 0;              ///< wall-clock time from the launch to tick 0
  std::optional<Contacts> contacts;  ///< absent: the physics server died before it reported them
  std::optional<Pacing> pacing;      ///< in real time only; absent as contacts is
  std::uint64_t lost = 0;            ///< samples that the recorder missed, or that came too late
  /// Whether processes read and write only the topics that they may (WireAudit). Absent: not checked, because the run
  /// ended before every endpoint was discovered, or because there is no wire.
  std::optional<bool> wire_matches_graph;
};

}  // namespace mascot
