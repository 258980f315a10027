#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/faults.h"
#include "experiment/graph/graph.h"

namespace mascot {

/// Which agents of a team hear which. The vectors have an entry for each agent, by id - 1.
struct TeamNetwork {
  std::vector<bool> is_there;             ///< of the team, and not lost
  std::vector<std::vector<int>> hearers;  ///< ids of those that hear this agent
  std::size_t edges = 0;

  int size() const { return static_cast<int>(is_there.size()); }
  bool Has(int id) const { return is_there[static_cast<std::size_t>(id - 1)]; }
  const std::vector<int>& HearersOf(int id) const { return hearers[static_cast<std::size_t>(id - 1)]; }
  std::vector<int> Ids() const {
    std::vector<int> ids;
    for (int id = 1; id <= size(); ++id)
      if (Has(id)) ids.push_back(id);
    return ids;
  }
};

/// The work that is spent on an experiment at most: about a second. In edges that are looked at.
inline constexpr std::int64_t kMaxSurvivalWork = 200'000'000;
/// Counts the work that is left.
class Budget {
 public:
  explicit Budget(std::int64_t work) : left_(work) {}
  void Take(std::size_t work) { left_ -= static_cast<std::int64_t>(work); }
  bool is_spent() const { return left_ < 0; }

 private:
  std::int64_t left_;
};

/// The fault of a part of the agent; null: it is in order. Of motors: null.
const Fault* FaultOf(const AgentConfig& agent, FaultPart part);
/// Whether nothing that the agent sends arrives, by its faults.
bool IsHeardByNobody(const AgentConfig& agent);
/// Whether a spanning tree is what the team's law needs, or may need, in a graph with edges.
bool NeedsTree(const Experiment& now);
/// The agents from which the tree has to begin: the leader, or several of which each agent has to hear one; empty: it
/// may begin at any.
std::vector<int> LeadersOf(const Experiment& now);

/// Which agents hear which on `graph`, in an experiment that events have changed to `now`. `is_there` says, by id - 1,
/// which agents count. Edges that are cut or deliver nothing are left out, and so is what faults and laws keep agents
/// from hearing.
TeamNetwork NetworkOf(const Experiment& now, const Graph& graph, std::vector<bool> is_there);
/// The agents that hear `from` neither directly nor through others, if the agent `without` (0: none) is not there,
/// either.
std::vector<int> NotReachedFrom(std::span<const int> from, const TeamNetwork& network, int without, Budget& budget);
/// Whether all hear one of `leaders`, or else, if there are none, one and the same agent; without the agent `without`.
bool HasTree(const TeamNetwork& network, std::span<const int> leaders, int without, Budget& budget);
/// The agents that do not hear, directly or through others, the group of agents that most others hear; empty: the
/// network has a spanning tree.
std::vector<int> CutOff(const TeamNetwork& network, Budget& budget);

}  // namespace mascot
