#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "agent/law.h"
#include "agent/link.h"
#include "agent/sensor.h"
#include "experiment/experiment.h"

namespace mascot {

/// What one agent hears of those that the graph lets it hear: applies who is there, the schedule, the range and the
/// links, so that its law never sees a sample that it could not have heard.
class Neighbours {
 public:
  Neighbours(const Experiment& experiment, int id);

  /// What the law hears at `tick` (increasing): `samples` are what the agents in experiment.graph.HeardBy(id), in that
  /// order, sent at this tick; `self` is where the agent really is. Valid until the next call.
  std::span<const Heard> Hear(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// Of the edges to experiment.graph.HeardBy(id), in that order.
  std::vector<EdgeCount> counts() const;

 private:
  /// The weight of the edge to `source` at this tick; 0: it is not there.
  double WeightOf(const Graph& graph, double t_s, int source) const;
  void Deliver(std::size_t k, std::int64_t tick);
  /// Nothing can keep a sample of these agents from being heard as it was sent.
  bool IsPlain() const;
  void HearPlain(std::span<const Sample> samples);

  const Experiment& experiment_;
  const AgentConfig& config_;
  const std::vector<Graph::Neighbour>& may_hear_;
  std::vector<Link> links_;    // by place in may_hear_
  std::vector<Noise> noises_;  // likewise
  std::vector<Heard> heard_;
  bool plain_;
  std::vector<EdgeCount> plain_counts_;  // likewise
};

/// Whether the agent's law is on at simulated time `t_s`.
bool IsOn(const AgentConfig& agent, double t_s);

}  // namespace mascot
