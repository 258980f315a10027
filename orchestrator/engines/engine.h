#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiment/contacts.h"
#include "experiment/pacing.h"

namespace mascot {

/// How a run went, from whichever engine ran it.
struct EngineResult {
  std::string failure;                     ///< empty: it ran to its end, or was stopped in order
  int signal = 0;                          ///< the signal that stopped it early, if one did
  double wall_s = 0;                       ///< from publishing tick 0 to the last command gathered
  double startup_s = 0;                    ///< from the start to tick 0
  std::optional<Contacts> contacts;        ///< absent: the physics server died before it told
  std::optional<Pacing> pacing;            ///< realtime; absent as above
  std::uint64_t lost = 0;                  ///< samples that the recorder knows to have missed
  std::optional<bool> wire_matches_graph;  ///< absent: ended before everybody was discovered
};

}  // namespace mascot
