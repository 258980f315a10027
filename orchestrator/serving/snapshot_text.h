#pragma once

#include <string>
#include <string_view>

#include "orchestrator/engines/episodes.h"

namespace mascot {

/// A snapshot as text, which a client can keep and bring back, to another server of the same experiment, too.
std::string TextOf(const Episodes::Snapshot& snapshot);
/// The inverse of TextOf(). Throws std::invalid_argument for other text.
Episodes::Snapshot SnapshotFrom(std::string_view text);

}  // namespace mascot
