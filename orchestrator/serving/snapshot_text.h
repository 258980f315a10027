#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "orchestrator/engines/stepped_team.h"

namespace mascot {

/// What a client chooses of an episode before it begins.
struct EpisodeStart {
  std::optional<std::uint64_t> seed = {};                          ///< absent: the file's
  nlohmann::ordered_json sets = nlohmann::ordered_json::object();  ///< values by key
  std::vector<int> ports = {};                                     ///< agents that take actions by DrivenAgents()
};

/// An episode so far. Its overrides (Snapshot::changes) are those of `start`.
struct ServedSnapshot {
  EpisodeStart start;
  SteppedTeam::Snapshot flown;
};

/// A snapshot as text, which a client can keep and bring back, to another server of the same experiment, too.
std::string TextOf(const ServedSnapshot& snapshot);
/// The inverse of TextOf(), without overrides: whoever has the text may have changed it. Throws std::invalid_argument
/// for other text.
ServedSnapshot SnapshotFrom(std::string_view text);

}  // namespace mascot
