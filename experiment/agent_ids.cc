#include "experiment/agent_ids.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace mascot {

std::vector<int> ReadAgentIds(Section& section, const std::string& key, int agents) {
  std::vector<int> ids;
  std::set<int> seen;
  const std::vector<double> numbers = section.Numbers(key);
  for (std::size_t k = 0; k < numbers.size() && !section.Wrong(key); ++k) {
    const int id = static_cast<int>(numbers[k]);
    if (id != numbers[k] || (agents > 0 && id > agents))
      section.FailRow(key, k, fmt::format("expected an agent in 1..{}, got {}", agents, numbers[k]));
    else if (!seen.insert(id).second)
      section.FailRow(key, k, EachOnce("agent", std::to_string(id)));
    else
      ids.push_back(id);
  }
  if (!section.Wrong(key)) section.Free(key);  // whole numbers, as they were written
  if (numbers.empty() && !section.Wrong(key)) section.Fail(key, "expected a list of agents, got nothing");
  std::ranges::sort(ids);
  return ids;
}

std::string IdRanges(const std::vector<int>& ids) {
  std::string text;
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(ids[i]);
    if (last > i) text += "-" + std::to_string(ids[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace mascot
