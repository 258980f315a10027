#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "agent/link.h"
#include "base/agent_range.h"
#include "experiment/experiment.h"
#include "experiment/silences.h"

namespace mascot {

/// What the bundles of a process hold (network.delivery = "bundled"): the newest motions and messages of its sources,
/// and which tick its agents can answer. A bundle has all that they need for its tick but events, and the actions of
/// agents that take some, which come by themselves. In lockstep it has the messages that were sent with the answers to
/// the tick before; in real time some may be missing.
///
/// No law, DDS, clock or lock: the caller passes in what arrives.
class BundleInbox {
 public:
  BundleInbox(const Experiment& experiment, AgentRange agents);

  enum class News {
    kOld,       ///< its tick was overtaken
    kAgain,     ///< its tick has been answered: the server may not have the answers
    kComplete,  ///< its tick can be answered now
    kWaits,     ///< for events or actions
  };
  /// Takes the newest bundle. Throws std::runtime_error, and takes nothing, if it does not hold the states of the
  /// sources, in order, and of one tick of the run, or has a message that it should not have.
  News OnBundle(std::span<const std::uint8_t> bytes);
  /// The next event, whose number this is. Returns whether the tick of the newest bundle can be answered now. Throws
  /// std::runtime_error if the newest bundle lacks the message of an agent that was not lost; so does OnBundle().
  bool OnEvent(int number, const Event& event);

  /// What somebody outside wants of agent `id` of this process. A late one is ignored. Returns as OnEvent() does.
  bool OnAction(int id, std::int64_t tick, std::span<const double> action);

  /// The tick of the newest bundle; -1: none.
  std::int64_t tick() const { return tick_; }
  /// Notes that its tick is answered.
  void Answered() { answered_ = tick_; }
  /// How many events have taken effect up to it.
  int events() const { return events_; }
  /// Of agent `id` of this process. Valid until the next bundle.
  const Motion& MotionOf(int id) const { return motions_[static_cast<std::size_t>(id - agents_.first)]; }
  /// What is wanted of agent `id` of this process at that tick; empty: none has come, or its law takes none. Valid
  /// until the next action.
  std::span<const double> ActionOf(int id) const;
  /// Samples of the agents in graph.HeardBy(id), in that order. Valid until the next call.
  std::span<const Sample> SamplesOf(int id);

 private:
  struct Message {
    std::int64_t tick = -1;  ///< with whose answer it was sent, or of the action; -1: none was
    std::vector<double> data;
  };

  bool IsComplete() const;
  /// As IsComplete(), of a bundle that has waited: throws as OnEvent() does.
  bool IsCompleteNow() const;
  /// Throws std::runtime_error if a bundle of `tick` lacks a message that it must have, as far as events are known.
  void RequireAllMessages(std::int64_t tick, std::span<const std::span<const std::uint8_t>> messages) const;
  /// The same of the message of one sender.
  void RequireMessageOf(int sender, std::int64_t tick, bool has_come) const;
  /// Throws std::runtime_error if these are not messages of a bundle of `tick`: in lockstep at most one of each sender,
  /// in the order of the sources, of the tick before; in real time those that have come, of earlier ticks.
  void RequireMessages(std::int64_t tick, std::span<const std::span<const std::uint8_t>> messages) const;

  const AgentRange agents_;
  const std::int64_t last_tick_;
  const bool realtime_;
  const std::vector<int> sources_;    // ids
  std::vector<int> senders_;          // ids of the sources that are heard here and send messages, in their order
  std::map<int, std::size_t> index_;  // in sources_, by id
  std::vector<std::vector<std::size_t>> heard_;  // by agent of this process: the sources that it may hear
  std::vector<Motion> motions_;                  // by source
  std::vector<Message> messages_;                // by source
  std::vector<int> takers_;                      // ids of the agents of this process that take actions
  std::vector<Message> actions_;                 // by agent of this process: the newest
  std::vector<Sample> samples_;
  std::int64_t tick_ = -1, answered_ = -1;
  int events_ = 0, known_events_ = 0;
  Silences silences_;
};

}  // namespace mascot
