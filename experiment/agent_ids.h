#pragma once

#include <string>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// Reads a list of agents under `key`, whose row is key::Numbers with the range [1, kMaxAgents]: whole numbers from 1
/// to `agents` (0: unknown), each once. Returns them in increasing order. Mistakes are noted in `section`.
std::vector<int> ReadAgentIds(Section& section, const std::string& key, int agents);

/// Ids as text, with consecutive ids joined: "1-4, 7".
std::string IdRanges(const std::vector<int>& ids);

}  // namespace mascot
