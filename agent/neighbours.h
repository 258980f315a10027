#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/false_data.h"
#include "agent/faulty_link.h"
#include "agent/laws/law.h"
#include "agent/link.h"
#include "agent/sensor.h"
#include "experiment/experiment.h"

namespace mascot {

/// What became of the samples on one edge, at one tick.
struct EdgeNow {
  enum class State : std::uint8_t {
    kNoEdge,      ///< the graph of this tick does not have the edge, or one of the agents is off
    kHeard,       ///< the law gets a sample
    kLost,        ///< the law gets no sample, although samples have arrived before
    kOutOfRange,  ///< the law gets no sample, and the agents are too far apart
    kNothingYet,  ///< no sample has ever arrived
  };
  State state = State::kNothingYet;
  double age_s = -1;  ///< simulated time since the newest sample that has arrived was sent; -1: none has
  /// Axes along which the law does not use the sample (LawEntry::left_out): bit k for axis k. LeftOutMeter sets it.
  std::uint8_t left_out = 0;
};

/// Decides what one agent hears of its neighbours: it applies start and stop times, the schedule of graphs, the range,
/// the lies, the links and the noise, so that the agent's law never sees a sample that the agent could not have heard.
class Neighbours {
 public:
  Neighbours(const Experiment& experiment, int id);

  /// From now on links, range, edges and faults are those of `experiment`, which must outlive this object or the next
  /// Adopt(). If a fresh agent has taken this one's place, nothing is on its way to it any more.
  void Adopt(const Experiment& experiment);
  /// What the law hears at `tick` (increasing). `samples` are what the agents in experiment.graph.HeardBy(id) sent at
  /// this tick, in that order. `self` is the agent's true motion, for the range. Valid until the next call, and as long
  /// as `samples`.
  std::span<const Heard> Hear(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// Counters of the edges from experiment.graph.HeardBy(id), in that order.
  std::vector<EdgeCount> counts() const;
  /// Appends what became of the edges from experiment.graph.HeardBy(id) at the tick of the last Hear(), in that order.
  void AddEdgesTo(std::vector<EdgeNow>& edges) const;
  /// Appends how many samples the same edges have lost so far, in the same order.
  void AddLossesTo(std::vector<std::uint64_t>& lost) const;

 private:
  /// What an edge needs as long as not every sample is heard at once as it was sent.
  struct Channel {
    Link link;
    Noise noise;
    std::optional<FalseData> false_data = {};
    std::optional<FaultyLink> faulty = {};
  };

  void MakeChannels();
  /// Lets channel `k` adopt what the experiment says of its link and its sender.
  void AdoptIn(std::size_t k);
  EdgeNow EdgeAt(std::size_t k) const;
  /// The weight of the edge from `source` at `t_s`; 0: there is no edge, or one of the agents is off.
  double WeightOf(const Graph& graph, double t_s, int source) const;
  /// Adds what link `k` delivers at `tick` to heard_.
  void Deliver(std::size_t k, std::int64_t tick);
  /// True if every sample is heard at once as it was sent: one graph, no range, perfect links, no noise, and these
  /// agents are on from start to end.
  bool IsPlain() const;
  /// What agent may_hear_[k] sends at `tick`: the truth, or its lie, or what its radio makes of it; valid until the
  /// next call.
  Sample SaidBy(std::size_t k, std::int64_t tick, const Sample& truth);
  void HearPlain(std::span<const Sample> samples);
  /// `message`, which agent may_hear_[k] sent with its answer to `tick`; empty if that was before its law began: the
  /// message of another law.
  std::span<const double> OfItsLaw(std::size_t k, std::int64_t tick, std::span<const double> message) const;

  const Experiment* experiment_;
  int id_;
  const std::vector<Graph::Neighbour> may_hear_;
  std::vector<Channel> channels_;  // by index in may_hear_; empty as long as plain_: they take a kilobyte an edge
  Motion false_motion_;
  std::vector<double> false_message_;
  std::vector<Heard> heard_;
  std::vector<EdgeNow::State> edge_states_;  // by index in may_hear_: kNoEdge, kOutOfRange, or else kLost
  std::int64_t tick_ = -1;                   // of the last Hear()
  bool plain_;
  /// By index in may_hear_: of ticks at which plain_ held, and of links that a fresh agent has left behind.
  std::vector<EdgeCount> early_counts_;
};

/// Whether the agent's law is on, and other agents may hear the agent: from start_s to stop_s, without the latter, and
/// while the agent is not lost.
bool IsOn(const AgentConfig& agent, double t_s);

}  // namespace mascot
