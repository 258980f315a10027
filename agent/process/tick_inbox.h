#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/link.h"
#include "base/motion.h"
#include "experiment/silences.h"

namespace mascot {

/// Collects the samples that arrive for one agent, and tells which ticks it can answer. Tick k is complete when the
/// agent's own state and those of its peers have arrived, all of tick k, the events up to it, and in lockstep also the
/// messages that its peers, unless they were lost, sent with their answers to tick k-1. An agent that takes actions
/// needs that of tick k as well, unless it is lost. Each tick is complete once. In real time messages may be missing,
/// and a tick that is overtaken by the next one never becomes complete: the server holds the agent's last command.
///
/// No law, DDS, clock or lock: the caller passes in what arrives.
class TickInbox {
 public:
  /// An agent that this one may hear.
  struct Peer {
    int id = 0;
    bool sends_messages = false;
  };

  /// The input of one answer. Valid until the next call.
  struct CompleteTick {
    std::int64_t tick = -1;
    const Motion* self = nullptr;
    /// One for each peer, in order, with the peer's last message before this tick.
    std::span<const Sample> samples = {};
    int events = 0;                       ///< how many events have taken effect up to this tick
    std::span<const double> action = {};  ///< of this tick; empty: none has come, or its law takes none
  };

  TickInbox(int id, const std::vector<Peer>& peers, bool realtime, bool takes_actions = false);

  // Each takes what arrives and returns the tick that becomes complete with it, if any. `source`: 0 is the agent
  // itself, then its peers in order. A sample that is late, doubled or of a negative tick is ignored.
  std::optional<CompleteTick> OnState(std::size_t source, std::int64_t tick, const Motion& motion, int events = 0);
  std::optional<CompleteTick> OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data);
  /// What somebody outside wants of the agent.
  std::optional<CompleteTick> OnAction(std::int64_t tick, std::span<const double> action);
  /// The next event, whose number this is.
  std::optional<CompleteTick> OnEvent(int number, const Event& event);

 private:
  /// A message and the tick that its sender answered with it, or an action and its tick; -1 and empty: none has
  /// arrived.
  struct Message {
    std::int64_t tick = -1;
    std::vector<double> data;
  };

  /// The newest samples of one agent.
  struct Source {
    Peer agent = {};
    std::int64_t tick = -1;  ///< the tick of `motion`
    Motion motion = {};
    int events = 0;                        ///< up to that tick
    std::array<Message, 2> messages = {};  ///< the last two, by tick modulo 2: a peer may be one answer ahead of us
  };

  /// Stores a state. Returns false if it is not newer than the one stored.
  static bool Take(Source& source, std::int64_t tick, const Motion& motion, int events);
  std::optional<CompleteTick> TakeIfComplete();
  /// True if everything that `tick` needs of this source has arrived.
  bool IsComplete(const Source& source, std::int64_t tick) const;
  /// The motion of `source`, and the last message that it sent before `tick`; empty: it sent none.
  static Sample SampleAt(const Source& source, std::int64_t tick);

  const bool realtime_, takes_actions_;
  std::vector<Source> sources_;  // the agent itself, then its peers
  std::vector<Sample> samples_;  // CompleteTick::samples
  Message action_;               // the newest
  std::int64_t answered_ = -1;   // the last tick that was complete
  int events_ = 0;               // number of the last event that has arrived
  Silences silences_;
};

}  // namespace mascot
