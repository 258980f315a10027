#pragma once

#include <string>
#include <vector>

namespace mascot {

/// "agent 3" or "agents 2, 5-9", for messages.
std::string AgentsText(const std::vector<int>& ids);

}  // namespace mascot
