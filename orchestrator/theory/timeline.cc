#include "orchestrator/theory/timeline.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "agent/neighbours.h"
#include "orchestrator/theory/links_on_average.h"

namespace mascot {
namespace {

constexpr int kMaxRepeats = 100;  // most repetitions of repeat_s that are tried to get a whole number of ticks

/// Times within the run at which an agent's law is switched on or off (s).
std::set<double> SwitchTimes(const Experiment& experiment) {
  std::set<double> times_s;
  for (const AgentConfig& agent : experiment.agents)
    for (const double time_s : {agent.start_s, agent.stop_s})
      if (time_s > 0 && time_s < experiment.run.duration_s) times_s.insert(time_s);
  return times_s;
}

/// Adds the ticks at which a change at `time_s` may take effect: two, because of rounding.
void AddTicks(double time_s, int rate_hz, std::set<std::int64_t>& ticks) {
  const auto before = std::llround(std::floor(time_s * rate_hz));
  ticks.insert({before, before + 1});
}

/// Number of repetitions of the schedule that take a whole number of ticks; 0: none up to kMaxRepeats does.
int RepeatsPerCycle(const Experiment& experiment) {
  const double ticks = experiment.schedule.repeat_s() * experiment.control.rate_hz;
  for (int repeats = 1; repeats <= kMaxRepeats; ++repeats)
    if (std::abs(repeats * ticks - std::round(repeats * ticks)) < 1e-6 && repeats * ticks > 0.5) return repeats;
  return 0;
}

Timeline::Interval IntervalAt(const Experiment& experiment, std::int64_t tick) {
  const double t_s = experiment.time_s(tick);
  std::vector<bool> on;
  for (const AgentConfig& agent : experiment.agents) on.push_back(IsOn(agent, t_s));
  const Graph& graph = experiment.schedule.At(t_s);
  std::vector<std::vector<Graph::Neighbour>> heard(on.size());
  for (std::size_t i = 0; i < on.size(); ++i)
    for (const Graph::Neighbour& neighbour : graph.HeardBy(static_cast<int>(i) + 1))
      if (on[i] && on[static_cast<std::size_t>(neighbour.id - 1)]) heard[i].push_back(neighbour);
  return {tick, OnAverage(Graph(std::move(heard)), experiment.links), std::move(on)};
}

bool Same(const Graph& a, const Graph& b) {
  for (int id = 1; id <= a.size(); ++id)
    if (!std::ranges::equal(a.HeardBy(id), b.HeardBy(id),
                            [](const auto& x, const auto& y) { return x.id == y.id && x.weight == y.weight; }))
      return false;
  return true;
}

}  // namespace

const Timeline::Interval& Timeline::At(std::int64_t tick) const {
  if (tick > cycle_from) tick = cycle_from + (tick - cycle_from) % cycle_ticks;
  const auto next = std::ranges::upper_bound(intervals, tick, {}, &Interval::from);
  return *std::prev(next);
}

double Timeline::WeightOf(int hearer, int heard, std::int64_t tick) const {
  if (tick < 0) return 0;
  const auto& edges = At(tick).graph.HeardBy(hearer);
  const auto edge = std::ranges::lower_bound(edges, heard, {}, &Graph::Neighbour::id);
  return edge != edges.end() && edge->id == heard ? edge->weight : 0;
}

std::optional<Timeline> TimelineOf(const Experiment& experiment) {
  const Schedule& schedule = experiment.schedule;
  const int rate_hz = experiment.control.rate_hz;
  std::set<std::int64_t> ticks = {0};
  for (const double time_s : SwitchTimes(experiment)) AddTicks(time_s, rate_hz, ticks);

  Timeline timeline;
  const bool repeats = schedule.repeat_s() > 0 && schedule.phases().size() > 1;
  if (repeats) {
    const int per_cycle = RepeatsPerCycle(experiment);
    if (per_cycle == 0) return std::nullopt;
    timeline.cycle_ticks = std::llround(per_cycle * schedule.repeat_s() * rate_hz);
    const std::int64_t cycles = *ticks.rbegin() / timeline.cycle_ticks + (*ticks.rbegin() > 0);
    timeline.cycle_from = cycles * timeline.cycle_ticks;
    const std::int64_t repetitions = (cycles + 1) * per_cycle;
    if (static_cast<double>(repetitions) * static_cast<double>(schedule.phases().size()) > kMaxIntervals)
      return std::nullopt;
    for (std::int64_t n = 0; n < repetitions; ++n)
      for (const Schedule::Phase& phase : schedule.phases())
        AddTicks(static_cast<double>(n) * schedule.repeat_s() + phase.at_s, rate_hz, ticks);
    ticks.erase(ticks.lower_bound(timeline.cycle_from + timeline.cycle_ticks), ticks.end());
  } else {
    for (const Schedule::Phase& phase : schedule.phases()) AddTicks(phase.at_s, rate_hz, ticks);
  }

  for (const std::int64_t tick : ticks) {
    Timeline::Interval interval = IntervalAt(experiment, tick);
    const bool as_before = !timeline.intervals.empty() && interval.on == timeline.intervals.back().on &&
                           Same(interval.graph, timeline.intervals.back().graph);
    if (!as_before || (repeats && tick == timeline.cycle_from)) timeline.intervals.push_back(std::move(interval));
  }
  if (!repeats) timeline.cycle_from = timeline.intervals.back().from;
  return timeline;
}

}  // namespace mascot
