#include "physics_server/process/agents_text.h"

#include "experiment/agent_ids.h"

namespace mascot {

std::string AgentsText(const std::vector<int>& ids) { return (ids.size() == 1 ? "agent " : "agents ") + IdRanges(ids); }

}  // namespace mascot
