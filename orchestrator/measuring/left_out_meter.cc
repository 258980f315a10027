#include "orchestrator/measuring/left_out_meter.h"

#include <cassert>

#include "agent/laws/laws.h"

namespace mascot {

LeftOutMeter::LeftOutMeter(const Experiment& experiment) : experiment_(experiment) {
  if (!EverLeavesOut(experiment)) return;
  for (const AgentConfig& agent : experiment.agents) {
    neighbours_.emplace_back(experiment, agent.id);
    sensors_.emplace_back(experiment.sensors, experiment.control.rate_hz, experiment.run.seed, agent.id);
  }
}

void LeftOutMeter::Adopt(const std::shared_ptr<const Experiment>& now) {
  if (!is_needed()) return;
  for (Neighbours& neighbours : neighbours_) neighbours.Adopt(*now);
  now_ = now;
}

void LeftOutMeter::Add(std::int64_t tick, std::span<const Motion> motions) {
  if (!is_needed()) return;
  left_out_.clear();
  for (const AgentConfig& agent : (now_ ? *now_ : experiment_).agents) AddAgent(agent, tick, motions);
}

void LeftOutMeter::AddAgent(const AgentConfig& agent, std::int64_t tick, std::span<const Motion> motions) {
  const auto i = static_cast<std::size_t>(agent.id - 1);
  const auto& may_hear = experiment_.graph.HeardBy(agent.id);
  samples_.clear();  // without messages, on which motions do not depend
  for (const Graph::Neighbour& neighbour : may_hear)
    samples_.push_back({.motion = &motions[static_cast<std::size_t>(neighbour.id - 1)]});
  const std::span<const Heard> heard = neighbours_[i].Hear(tick, motions[i], samples_);
  const Motion measured = sensors_[i].Measure(tick, motions[i]);
  const std::size_t first = left_out_.size();
  left_out_.resize(first + may_hear.size());
  const auto ask = EntryOf(agent.law).left_out;
  if (ask == nullptr || !IsOn(agent, experiment_.time_s(tick))) return;
  const std::vector<std::uint8_t> answer = ask(agent.law, measured, heard);
  const unsigned axes = (1u << CountOf(agent.law.axes)) - 1;  // the law controls no others
  for (std::size_t n = 0, k = 0; n < heard.size(); ++n) {     // both in increasing id
    while (may_hear[k].id != heard[n].id) ++k;
    left_out_[first + k] = static_cast<std::uint8_t>(answer[n] & axes);
  }
}

void LeftOutMeter::Mark(std::vector<EdgeNow>& edges) const {
  if (left_out_.empty()) return;
  assert(edges.size() == left_out_.size());
  for (std::size_t k = 0; k < edges.size(); ++k) edges[k].left_out = left_out_[k];
}

}  // namespace mascot
