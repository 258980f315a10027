#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "agent/law.h"
#include "agent/link.h"
#include "agent/sensor.h"
#include "experiment/experiment.h"

namespace mascot {

/// Decides what one agent hears of its neighbours: applies start and stop times, the schedule of graphs, the range, the
/// links and the noise, so that its law never sees a sample that it could not have heard.
class Neighbours {
 public:
  Neighbours(const Experiment& experiment, int id);

  /// What the law hears at `tick` (increasing). `samples`: what the agents in experiment.graph.HeardBy(id) sent at this
  /// tick, in that order. `self`: the agent's true motion, for the range. Valid until the next call, and as long as
  /// `samples`.
  std::span<const Heard> Hear(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// Counters of the edges from experiment.graph.HeardBy(id), in that order.
  std::vector<EdgeCount> counts() const;

 private:
  /// The weight of the edge from `source` at `t_s`; 0: there is no edge, or one of the agents is off.
  double WeightOf(const Graph& graph, double t_s, int source) const;
  /// Adds what link `k` delivers at `tick` to heard_.
  void Deliver(std::size_t k, std::int64_t tick);
  /// True if every sample is heard at once as it was sent: one graph, no range, perfect links, no noise, and these
  /// agents are on from start to end.
  bool IsPlain() const;
  void HearPlain(std::span<const Sample> samples);

  const Experiment& experiment_;
  const AgentConfig& config_;
  const std::vector<Graph::Neighbour>& may_hear_;
  std::vector<Link> links_;    // by index in may_hear_
  std::vector<Noise> noises_;  // by index in may_hear_
  std::vector<Heard> heard_;
  bool plain_;
  std::vector<EdgeCount> plain_counts_;  // by index in may_hear_
};

/// True from start_s until before stop_s: the agent's law is on, and others may hear it.
bool IsOn(const AgentConfig& agent, double t_s);

}  // namespace mascot
