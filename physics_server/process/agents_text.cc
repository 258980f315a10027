#include "physics_server/process/agents_text.h"

namespace mascot {

std::string AgentsText(const std::vector<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
  return (ids.size() == 1 ? "agent " : "agents ") + text;
}

}  // namespace mascot
