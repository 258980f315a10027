#include "experiment/agent_ids.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "base/number.h"

namespace mascot {
namespace {

std::optional<int> ToId(std::string_view text) {
  const auto id = NumberFrom<int>(text);
  return id > 0 ? id : std::nullopt;
}

/// "1-20" or "1-5,8"; nothing if it is not that, with agents up to `most`.
std::optional<std::vector<AgentRange>> ToRanges(std::string_view text, int most) {
  std::vector<AgentRange> ranges;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    more = comma != text.npos;
    text.remove_prefix(more ? comma + 1 : text.size());
    const std::size_t dash = part.find('-');
    const auto first = ToId(part.substr(0, dash)), last = dash == part.npos ? first : ToId(part.substr(dash + 1));
    if (!first || !last || *first > *last || *last > most) return std::nullopt;
    ranges.push_back({*first, *last});
  }
  return ranges;
}

}  // namespace

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

std::vector<AgentRange> ReadAgentRanges(Section& section, const std::string& key, int most) {
  const std::string words = section.Text(key);
  if (section.Wrong(key)) return {};
  if (auto ranges = ToRanges(words, most)) return *std::move(ranges);
  section.Fail(key, fmt::format("expected agents in 1..{}, such as \"1-20\" or \"1-5,8\", got '{}'", most, words));
  return {};
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
