#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/link.h"
#include "experiment/motion.h"

namespace mascot {

/// What has come for one agent, and the ticks that it can answer with that. Tick k is complete when the agent's own
/// state and those of its peers are there, all of tick k, and in lockstep what its peers sent when they answered tick
/// k-1. Each tick is complete once. In real time messages may be missing, and a tick that the next one overtakes never
/// is complete: the server holds the last command.
///
/// It has no law, wire, clock or lock: it is told what came.
class TickInbox {
 public:
  /// An agent that this one may hear.
  struct Peer {
    int id = 0;
    bool sends_messages = false;
  };

  /// All that an answer is made of. Valid until more comes.
  struct CompleteTick {
    std::int64_t tick = -1;
    const Motion* self = nullptr;
    std::span<const Sample> samples = {};  ///< of the peers, in order, each with the last message that it sent before
  };

  /// The state of one agent as a bundle has it.
  struct State {
    std::uint32_t agent = 0;
    std::int64_t tick = -1;
    Motion motion = {};
  };

  TickInbox(int id, const std::vector<Peer>& peers, bool realtime);

  // What comes, and the tick that is complete with it. `source`: 0 is the agent itself, then its peers in order. What
  // is late, doubled or of a negative tick is ignored.
  std::optional<CompleteTick> OnState(std::size_t source, std::int64_t tick, const Motion& motion);
  std::optional<CompleteTick> OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data);
  /// States of all sources, in order. Throws std::runtime_error if they are others.
  std::optional<CompleteTick> OnBundle(std::span<const State> states);

 private:
  /// A message and the tick whose answer it came with; -1 and empty: none has come.
  struct Message {
    std::int64_t tick = -1;
    std::vector<double> data;
  };

  /// What has come of one agent.
  struct Source {
    Peer agent = {};
    std::int64_t tick = -1;  ///< the tick of `motion`
    Motion motion = {};
    std::array<Message, 2> messages = {};  ///< the last two, by tick modulo 2: a peer may be one answer ahead of us
  };

  /// False: the state is not newer than what has come of its source.
  static bool Take(Source& source, std::int64_t tick, const Motion& motion);
  void CheckBundle(std::span<const State> states) const;
  std::optional<CompleteTick> TakeIfComplete();
  /// Everything that belongs to `tick` has come of this source.
  bool IsComplete(const Source& source, std::int64_t tick) const;
  /// The last message that `source` sent before `tick`; empty: it sent none.
  static std::span<const double> MessageBefore(const Source& source, std::int64_t tick);

  const bool realtime_;
  std::vector<Source> sources_;  // the agent itself, then its peers
  std::vector<Sample> samples_;  // what CompleteTick shows of them
  std::int64_t answered_ = -1;   // the last tick that was complete
};

}  // namespace mascot
