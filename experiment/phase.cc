#include "experiment/phase.h"

#include <algorithm>
#include <iterator>

namespace mascot {

std::vector<Motion> MotionsAtStart(const Experiment& experiment) {
  std::vector<Motion> starts;
  for (const AgentConfig& agent : experiment.agents) {
    starts.emplace_back();
    starts.back().p_WB = agent.p_W;
    starts.back().v_WB = agent.v_W;
  }
  return starts;
}

std::vector<std::int64_t> PhasesOf(const Experiment& experiment) {
  std::vector<std::int64_t> ticks;
  for (const Event& event : experiment.events)
    if (event.law && (ticks.empty() || ticks.back() != event.tick)) ticks.push_back(event.tick);
  return ticks;
}

std::int64_t EndOfPhase(const Experiment& experiment, std::int64_t from) {
  const auto later = std::ranges::upper_bound(experiment.events, from, {}, &Event::tick);
  const auto next = std::find_if(later, experiment.events.end(), [](const Event& event) { return event.law; });
  return next != experiment.events.end() ? next->tick : experiment.ticks();
}

std::span<const Event> EventsWithin(const Experiment& experiment, std::int64_t from, std::int64_t to) {
  const auto first = std::ranges::lower_bound(experiment.events, from, {}, &Event::tick);
  const auto end = std::ranges::lower_bound(experiment.events, std::max(from, to), {}, &Event::tick);
  return {first, end};
}

Experiment PhaseAsExperiment(const Experiment& start, const Experiment& now, std::int64_t from, std::int64_t to,
                             std::span<const Motion> starts) {
  Experiment phase = now;
  const double from_s = now.time_s(from);
  phase.run.duration_s = now.time_s(to - from);
  const std::span<const Event> within = EventsWithin(start, from, to);
  phase.events.clear();
  std::ranges::copy_if(within, std::back_inserter(phase.events), [](const Event& event) { return !event.law; });
  for (Event& event : phase.events) event.tick -= from;
  for (AgentConfig& agent : phase.agents) {
    const Motion& motion = starts[static_cast<std::size_t>(agent.id - 1)];
    agent.p_W = motion.p_WB;
    agent.v_W = motion.v_WB;
    agent.start_s = std::max(0.0, agent.start_s - from_s);
    agent.stop_s -= from_s;
    agent.law.since -= from;
    agent.faults.restarted -= from;
    if (agent.faults.lost_since) *agent.faults.lost_since -= from;
    for (PartFault& part : agent.faults.parts) part.since -= from;
    if (agent.lie) agent.lie->from_s = std::max(0.0, agent.lie->from_s - from_s);
  }
  return phase;
}

}  // namespace mascot
