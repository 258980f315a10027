#include "orchestrator/theory/persistence.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "agent/laws/parts/reach.h"
#include "orchestrator/theory/links_on_average.h"

namespace mascot {
namespace {

using Interval = Timeline::Interval;

/// Ids of the agents that do not stop during the run.
std::vector<int> Staying(const Experiment& experiment) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents)
    if (agent.stop_s >= experiment.run.duration_s) ids.push_back(agent.id);
  return ids;
}

/// The union of graphs. An extra edge connects each agent that stops during the run to one that stays, so that a
/// spanning tree need not reach it in another way.
Graph Union(const Experiment& experiment, const std::vector<const Graph*>& graphs) {
  std::vector<Schedule::Phase> phases;
  for (const Graph* graph : graphs) phases.push_back({0, *graph});
  const std::vector<int> staying = Staying(experiment);
  if (!staying.empty() && std::ssize(staying) < experiment.size()) {
    std::vector<std::vector<Graph::Neighbour>> extra_edges(experiment.agents.size());
    for (const AgentConfig& agent : experiment.agents)
      if (!std::ranges::binary_search(staying, agent.id))
        extra_edges[static_cast<std::size_t>(agent.id - 1)].push_back({staying.front(), 1});
    phases.push_back({0, Graph(std::move(extra_edges))});
  }
  return Schedule(std::move(phases), 0, 0).Union();
}

bool HasTree(const Experiment& experiment, const std::vector<const Graph*>& graphs) {
  const Graph graph = Union(experiment, graphs);
  const int leader = experiment.law.leader;
  return leader > 0 ? NotReached(graph, leader).empty() : !graph.Roots().empty();
}

/// The intervals that repeat; the last one, if none do.
std::span<const Interval> Cycle(const Timeline& timeline) {
  const auto first = std::ranges::find(timeline.intervals, timeline.cycle_from, &Interval::from);
  return {first, timeline.intervals.end()};
}

std::vector<const Graph*> Graphs(std::span<const Interval> intervals) {
  std::vector<const Graph*> graphs;
  for (const Interval& interval : intervals) graphs.push_back(&interval.graph);
  return graphs;
}

/// The length (s) such that the union over any window of this length has a tree: the longest of the shortest windows
/// that begin with an interval. Windows that begin later within the interval are shorter.
double Window(const Experiment& experiment, const Timeline& timeline) {
  const std::span<const Interval> cycle = Cycle(timeline);
  std::int64_t longest = 1;
  for (std::size_t first = 0; first < cycle.size(); ++first) {
    std::vector<const Graph*> graphs = {&cycle[first].graph};
    std::size_t last = first;
    while (!HasTree(experiment, graphs)) graphs.push_back(&cycle[++last % cycle.size()].graph);
    if (last == first) continue;
    const auto wraps = static_cast<std::int64_t>(last / cycle.size());
    const std::int64_t reached = cycle[last % cycle.size()].from + wraps * timeline.cycle_ticks;
    longest = std::max(longest, reached + 1 - cycle[first].from);  // its first tick is enough
  }
  return experiment.time_s(longest);
}

/// The edges between agents that are within graph.range_m of each other at the start.
Graph WithinRange(const Experiment& experiment) {
  std::vector<std::vector<Graph::Neighbour>> heard(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents)
    for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(agent.id))
      if ((experiment.agent(neighbour.id).p_W - agent.p_W).norm() < experiment.schedule.range_m())
        heard[static_cast<std::size_t>(agent.id - 1)].push_back(neighbour);
  return Graph(std::move(heard));
}

/// Why there is no tree: no agent is heard by all others, or some agents do not hear the leader.
std::string Lack(const Experiment& experiment, const std::vector<const Graph*>& graphs) {
  const int leader = experiment.law.leader;
  if (leader == 0) return "nobody is heard by everyone, directly or not (no spanning tree)";
  return fmt::format("leader {} is not heard, directly or not, by {}", leader,
                     AgentList(NotReached(Union(experiment, graphs), leader)));
}

/// What the lack means: ", so agents will not all meet", or the same with a leader. `may`: "will" or "may".
std::string Consequence(const Experiment& experiment, std::string_view may) {
  return experiment.law.leader == 0 ? fmt::format(", so agents {} not all meet", may)
                                    : fmt::format(", who {} not follow", may);
}

/// The key that causes the lack of a tree.
std::string Culprit(const Experiment& experiment, const Timeline& timeline) {
  const auto& phases = experiment.schedule.phases();
  std::vector<const Graph*> scheduled;  // without losses and absent agents
  for (const Schedule::Phase& phase : phases) scheduled.push_back(&phase.graph);
  if (experiment.schedule.repeat_s() == 0) scheduled = {scheduled.back()};
  if (!HasTree(experiment, scheduled)) {
    if (phases.size() > 1) return "graph.schedule";
    return experiment.law.leader > 0 ? "law.leader" : "graph";
  }
  std::vector<Graph> delivered;  // the same with the losses of the links
  for (const Graph* graph : scheduled) delivered.push_back(OnAverage(*graph, experiment.links));
  std::vector<const Graph*> delivering;
  for (const Graph& graph : delivered) delivering.push_back(&graph);
  if (!HasTree(experiment, delivering)) return "link.loss";
  const std::vector<bool>& on = timeline.intervals.back().on;
  const bool stopped = Staying(experiment).size() < on.size();
  return stopped ? "agents.override.stop_s" : "agents.override.start_s";
}

}  // namespace

Persistence PersistenceOf(const Experiment& experiment, const Timeline& timeline) {
  Persistence persistence;
  std::vector<bool> alone;
  for (const Interval& interval : timeline.intervals) alone.push_back(HasTree(experiment, {&interval.graph}));
  persistence.always = std::ranges::all_of(alone, std::identity());
  persistence.never_alone = std::ranges::none_of(alone, std::identity());
  persistence.joint = HasTree(experiment, Graphs(Cycle(timeline)));
  if (persistence.joint && timeline.cycle_ticks > 1) persistence.window_s = Window(experiment, timeline);
  if (persistence.joint && timeline.cycle_ticks == 1) {
    std::size_t first = alone.size() - 1;
    while (first > 0 && alone[first - 1]) --first;
    persistence.from_s = experiment.time_s(timeline.intervals[first].from);
  }
  if (experiment.schedule.range_m() > 0) {
    const Graph near = WithinRange(experiment);
    persistence.in_range_at_start = HasTree(experiment, {&near});
  }
  return persistence;
}

std::vector<std::string> PersistenceWarnings(const Experiment& experiment, const Timeline& timeline,
                                             const Persistence& persistence) {
  std::vector<std::string> warnings;
  if (!persistence.joint) {
    const std::vector<const Graph*> graphs = Graphs(Cycle(timeline));
    std::string when;
    if (timeline.cycle_ticks > 1)
      when = "in the union of its graphs ";
    else if (!timeline.IsConstant())
      when = fmt::format("from {:g} s on ", experiment.time_s(timeline.cycle_from));
    warnings.push_back(fmt::format("{}: {}{}{}", Culprit(experiment, timeline), when, Lack(experiment, graphs),
                                   Consequence(experiment, "will")));
  }
  if (persistence.joint && persistence.in_range_at_start == false) {
    const Graph near = WithinRange(experiment);
    warnings.push_back(fmt::format("graph.range_m: from where they start, with {:g} m, {}{}",
                                   experiment.schedule.range_m(), Lack(experiment, {&near}),
                                   Consequence(experiment, "may")));
  }
  return warnings;
}

std::string Describe(const Persistence& persistence) {
  std::string text;
  if (!persistence.joint)
    text = "none";
  else if (persistence.always)
    text = "at every time";
  else if (persistence.window_s)
    text = fmt::format("in the union of any {:.4g} s{}", *persistence.window_s,
                       persistence.never_alone ? "; at no time alone" : "");
  else
    text = fmt::format("from {:.4g} s on", *persistence.from_s);
  if (persistence.in_range_at_start)
    text += *persistence.in_range_at_start ? ", and within range at the start" : ", but not within range at the start";
  return text;
}

}  // namespace mascot
