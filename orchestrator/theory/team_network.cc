#include "orchestrator/theory/team_network.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "agent/laws/laws.h"
#include "orchestrator/theory/links_on_average.h"

namespace mascot {
namespace {

constexpr int kAll = -1;

/// By id - 1, to whom an agent listens by its law: to the parent that it pursues, to nobody (0), or to all (kAll).
std::vector<int> ListenedTo(const Experiment& now) {
  std::vector<int> to(now.agents.size(), kAll);
  const std::optional<PursuitForm> team = PursuitFormOf(now.law);
  for (const AgentConfig& agent : now.agents) {
    const auto i = static_cast<std::size_t>(agent.id - 1);
    const std::optional<PursuitForm> own = agent.has_own_law ? PursuitFormOf(agent.law) : std::nullopt;
    const std::optional<LinearForm> linear = agent.has_own_law ? LinearFormOf(agent.law) : std::nullopt;
    if (const auto& form = agent.has_own_law ? own : team) to[i] = form->parent[i];
    if (linear && !linear->listens) to[i] = 0;
  }
  return to;
}

/// Goes through a network without one of its agents.
class Walk {
 public:
  /// `without`: 0 for none.
  Walk(const TeamNetwork& network, int without, Budget& budget)
      : network_(network),
        without_(without),
        budget_(budget),
        is_seen_(network.is_there.size()),
        not_seen_(static_cast<int>(std::ranges::count(network.is_there, true)) -
                  static_cast<int>(without > 0 && network.Has(without))) {}

  /// Goes to all that hear `id`, directly or not.
  void From(int id) {
    See(id);
    while (!open_.empty()) {
      const int heard = open_.back();
      open_.pop_back();
      for (const int hearer : network_.HearersOf(heard)) {
        budget_.Take(1);
        if (!IsSeen(hearer)) See(hearer);
        if (not_seen_ == 0) return open_.clear();
      }
    }
  }
  bool IsSeen(int id) const { return is_seen_[static_cast<std::size_t>(id - 1)] || id == without_; }
  bool IsThere(int id) const { return network_.Has(id) && id != without_; }
  std::vector<int> NotSeen() const {
    std::vector<int> ids;
    for (int id = 1; id <= network_.size(); ++id)
      if (IsThere(id) && !IsSeen(id)) ids.push_back(id);
    return ids;
  }

 private:
  void See(int id) {
    is_seen_[static_cast<std::size_t>(id - 1)] = true;
    --not_seen_;
    open_.push_back(id);
  }

  const TeamNetwork& network_;
  const int without_;
  Budget& budget_;
  std::vector<bool> is_seen_;
  int not_seen_;           // of those that are there
  std::vector<int> open_;  // seen, and who hears them is not yet
};

/// Agents such that everyone hears one of them, directly or not: each is the first of those that only itself, or later
/// ones, reach. If anybody is heard by all, the last one is.
std::vector<int> StartsOf(const TeamNetwork& network, int without, Budget& budget) {
  std::vector<int> starts;
  Walk walk(network, without, budget);
  budget.Take(network.is_there.size());
  for (int id = 1; id <= network.size(); ++id) {
    if (!walk.IsThere(id) || walk.IsSeen(id)) continue;
    walk.From(id);
    starts.push_back(id);
  }
  return starts;
}

}  // namespace

const Fault* FaultOf(const AgentConfig& agent, FaultPart part) {
  const PartFault* found = agent.faults.Of(part);
  return found != nullptr ? &found->fault : nullptr;
}

bool IsHeardByNobody(const AgentConfig& agent) {
  const Fault* link = FaultOf(agent, FaultPart::kLink);
  const bool sends_nothing = link != nullptr && (link->kind == FaultKind::kOff ||
                                                 (link->kind == FaultKind::kIntermittent && link->probability == 1));
  return agent.faults.is_mute || sends_nothing;
}

bool NeedsTree(const Experiment& now) {
  const LawConfig& law = now.law;
  const LawEntry& entry = EntryOf(law);
  const std::optional<LinearForm> linear = LinearFormOf(law);
  if (now.graph.edges() == 0 || (linear && !linear->listens)) return false;
  return entry.agrees || entry.is_of_user || law.leader > 0 || !HullOf(law).empty() || PursuitFormOf(law).has_value();
}

std::vector<int> LeadersOf(const Experiment& now) {
  if (now.law.leader > 0) return {now.law.leader};
  const std::span<const int> hull = HullOf(now.law);
  return {hull.begin(), hull.end()};
}

TeamNetwork NetworkOf(const Experiment& now, const Graph& graph, std::vector<bool> is_there) {
  TeamNetwork network{.is_there = std::move(is_there), .hearers = std::vector<std::vector<int>>(now.agents.size())};
  const std::vector<int> listened_to = ListenedTo(now);
  const Graph delivered = OnAverage(graph, now.links);
  for (const AgentConfig& hearer : now.agents) {
    if (!network.Has(hearer.id) || hearer.faults.is_deaf) continue;
    const int only = listened_to[static_cast<std::size_t>(hearer.id - 1)];
    for (const auto& [heard, weight] : delivered.HeardBy(hearer.id)) {
      if (!network.Has(heard) || (only != kAll && heard != only) || IsHeardByNobody(now.agent(heard)) ||
          now.cut.contains({hearer.id, heard}))
        continue;
      network.hearers[static_cast<std::size_t>(heard - 1)].push_back(hearer.id);
      ++network.edges;
    }
  }
  return network;
}

std::vector<int> NotReachedFrom(std::span<const int> from, const TeamNetwork& network, int without, Budget& budget) {
  Walk walk(network, without, budget);
  for (const int id : from)
    if (walk.IsThere(id) && !walk.IsSeen(id)) walk.From(id);
  return walk.NotSeen();
}

bool HasTree(const TeamNetwork& network, std::span<const int> leaders, int without, Budget& budget) {
  if (!leaders.empty()) return NotReachedFrom(leaders, network, without, budget).empty();
  const std::vector<int> starts = StartsOf(network, without, budget);
  if (starts.size() <= 1) return true;
  return NotReachedFrom(std::span(&starts.back(), 1), network, without, budget).empty();
}

std::vector<int> CutOff(const TeamNetwork& network, Budget& budget) {
  constexpr std::size_t kMostTried = 100;  // beyond, another group may be heard by more; what is said stays true
  if (HasTree(network, {}, 0, budget)) return {};
  const std::vector<int> starts = StartsOf(network, 0, budget);
  std::vector<int> fewest = network.Ids();
  for (std::size_t k = 0; k < std::min(starts.size(), kMostTried); ++k) {
    std::vector<int> rest = NotReachedFrom(std::span(&starts[k], 1), network, 0, budget);
    if (rest.size() < fewest.size()) fewest = std::move(rest);
  }
  return fewest;
}

}  // namespace mascot
