#include "experiment/graph/schedule.h"

#include <algorithm>
#include <cmath>

#include "experiment/toml/few_tables.h"

namespace mascot {

namespace {

constexpr std::size_t kMaxGraphs = 10000;

/// The keys of one graph, and `more`.
std::vector<Key> WithGraphKeys(std::initializer_list<Key> more) {
  std::vector<Key> keys(GraphKeys().begin(), GraphKeys().end());
  keys.insert(keys.end(), more);
  return keys;
}

}  // namespace

const Graph& Schedule::At(double t_s) const {
  constexpr double kRounding_s = 1e-9;  // tolerance for rounding, far below a physics step
  double t = t_s + kRounding_s;
  if (repeat_s_ > 0) t = std::fmod(t, repeat_s_);
  const auto next = std::upper_bound(phases_->begin() + 1, phases_->end(), t,
                                     [](double at, const Phase& phase) { return at < phase.at_s; });
  return std::prev(next)->graph;
}

Graph Schedule::Union() const {
  std::vector<std::vector<Graph::Neighbour>> heard(static_cast<std::size_t>(phases_->front().graph.size()));
  for (const Phase& phase : *phases_)
    for (std::size_t i = 0; i < heard.size(); ++i)
      for (const Graph::Neighbour& neighbour : phase.graph.HeardBy(static_cast<int>(i) + 1)) {
        const auto place = std::ranges::lower_bound(heard[i], neighbour.id, {}, &Graph::Neighbour::id);
        if (place == heard[i].end() || place->id != neighbour.id) heard[i].insert(place, neighbour);
      }
  return Graph(std::move(heard));
}

std::span<const Key> ScheduleKeys() {
  static const std::vector<Key> phase_keys = WithGraphKeys(
      {key::Number("at_s", Above(0, 1e6), "when this graph takes over; later than the graph before").Required()});
  static const std::vector<Key> keys = WithGraphKeys({
      key::Tables("schedule", phase_keys, "graphs that replace this one later, in order of time; at most 10000"),
      key::Number("repeat_s", Above(0, 1e6), "after this time the schedule starts again").Otherwise("never"),
      key::Number("range_m", Above(0, 1e6), "an edge works only while its agents are closer than this")
          .Otherwise("at any distance")
          .Live(),
  });
  return keys;
}

double ReadRange(Section& graph) { return graph.Has("range_m") ? graph.Number("range_m") : 0; }

Schedule ReadSchedule(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed) {
  std::vector<Schedule::Phase> phases;
  phases.push_back({0, ReadGraph(graph, p_W, seed)});
  constexpr std::uint64_t kNextStage = std::uint64_t{1} << 40;  // runs with seeds 1, 2, 3... then share no graph
  std::uint64_t stage_seed = seed;
  std::size_t edges = phases.back().graph.edges();
  for (Section& section : FewTables(graph, "schedule", kMaxGraphs)) {
    const double at_s = section.Number("at_s");
    if (!section.Wrong("at_s") && at_s <= phases.back().at_s)
      section.Fail("at_s",
                   "expected a time after " + ShortestFloat(phases.back().at_s) + ", got " + ShortestFloat(at_s));
    phases.push_back({at_s, ReadGraph(section, p_W, stage_seed += kNextStage)});
    section.Done();
    edges += phases.back().graph.edges();
    if (edges <= kMaxEdges) continue;
    section.Fail("", "expected at most " + std::to_string(kMaxEdges) + " edges in all graphs together, got more");
    break;
  }
  double repeat_s = 0;
  if (graph.Has("repeat_s")) {
    repeat_s = graph.Number("repeat_s");
    if (!graph.Wrong("repeat_s") && repeat_s <= phases.back().at_s)
      graph.Fail("repeat_s", "expected a time after the last of graph.schedule (" + ShortestFloat(phases.back().at_s) +
                                 "), got " + ShortestFloat(repeat_s));
  }
  const double range_m = ReadRange(graph);
  return Schedule(std::move(phases), repeat_s, range_m);
}

}  // namespace mascot
