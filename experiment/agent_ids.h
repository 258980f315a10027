#pragma once

#include <string>
#include <vector>

#include "base/agent_range.h"
#include "experiment/toml/section.h"

namespace mascot {

/// Reads a list of agents under `key`, whose row is key::Numbers with the range [1, kMaxAgents]: whole numbers from 1
/// to `agents` (0: unknown), each once. Returns them in increasing order. Mistakes are noted in `section`.
std::vector<int> ReadAgentIds(Section& section, const std::string& key, int agents);

/// Reads agents in words under `key`, "1-20" or "1-5,8", each in 1..most. Empty after a mistake, which is noted.
std::vector<AgentRange> ReadAgentRanges(Section& section, const std::string& key, int most);

/// Ids as text, with consecutive ids joined: "1-4, 7".
std::string IdRanges(const std::vector<int>& ids);

}  // namespace mascot
