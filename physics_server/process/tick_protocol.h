#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "physics_server/process/progress_watch.h"
#include "physics_server/process/tick_barrier.h"
#include "physics_server/process/tick_gate.h"

namespace mascot {

/// The server's side of the tick protocol: decides when states are published, which commands count, when the world
/// steps, and when waiting has taken too long. In lockstep a tick ends with the last agent's command. In real time it
/// ends when the next one is due, and a late agent's last command is held; only the first and the last tick wait for
/// every command. In both modes, a TickGate says when a tick may happen: in lockstep the tick is published no earlier;
/// in real time the tick before ends then. In a pause of lockstep nobody is late: who answers then is waited for once
/// the pause is over, or a step is asked for.
///
/// No world, DDS, clock or lock: the caller passes in what arrives, and the time when it looks. The caller must carry
/// out the returned actions of each call at once, before the next call.
class TickProtocol {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Rules {
    int agents = 0;
    std::int64_t last_tick = 0;
    double period_s = 0;               ///< simulated time between two ticks
    double pace = 0;                   ///< simulated seconds per second; 0: as fast as the machine can
    bool realtime = false;             ///< real time, with a pace above 0; else lockstep
    double agent_timeout_s = 0;        ///< run.agent_timeout_s
    std::int64_t recorder_window = 0;  ///< tick k is published once the recorder has tick k - recorder_window
  };

  /// What the caller must do, in this order.
  struct Actions {
    bool take = false;     ///< hold this command in place of the agent's last one
    bool step = false;     ///< step the world to its next tick, with the commands held
    bool publish = false;  ///< publish the states of the world's tick
    bool ask = false;      ///< ask agents again that have not answered the newest tick
    bool wake = false;     ///< wake the loop, so that it calls Look() at once
    bool operator==(const Actions&) const = default;
  };

  /// The answer to Look().
  struct Turn {
    Actions actions = {};
    std::optional<Time> due = {};            ///< set if a tick ends in real time: when the next one was due
    std::optional<Time> next_deadline = {};  ///< when to call Look() at the latest; nullopt: the run is over
    bool held = false;                       ///< nothing but the gate, or Hold(), keeps the next tick from happening
    std::string failure = {};                ///< why the run has failed; empty: it has not
    std::vector<int> late = {};              ///< with a failure: the agents that it is due to; none: it is the recorder
  };

  explicit TickProtocol(const Rules& rules);

  /// Call it when all processes are ready: the ticks start. Before this, commands are ignored and nothing is published.
  Actions Start();
  /// Call it when the recorder has confirmed all rows before row `rows`.
  Actions OnRecorded(std::int64_t rows);
  /// Call it when agent `id` (1..N) has answered `tick`. The command counts only if `tick` is published and later than
  /// the agent's last answer.
  Actions OnCommand(int id, std::int64_t tick, bool stop_requested);
  /// Call it when agent `id` is lost: it is not waited for any more, and its commands do not count. `unanswered`: the
  /// event that says so comes at the next tick.
  Actions Lose(int id, bool unanswered);
  /// Call it when a fresh agent has taken the place of agent `id`, before the first tick that it answers is published
  /// or right after.
  void Regain(int id) { barrier_.Include(id); }
  /// From now on the world's next tick is not published, until Release().
  void Hold() { held_ = true; }
  Actions Release();
  /// The loop calls it after Start(), when the gate has changed, and when Turn::next_deadline says so: it lets ticks
  /// happen that are due, and fails if an agent or the recorder is late.
  Turn Look(Time now, bool stop_requested);
  /// Decides when ticks may happen; it may be changed at any time.
  TickGate& gate() { return gate_; }

  /// True when the last tick is answered or a requested stop has taken effect. From then on no command counts and
  /// nothing is published.
  bool finished() const { return finished_; }
  /// The newest tick published; -1: none.
  std::int64_t published() const { return published_; }
  /// The newest tick of which all is known: the last one, without that of which only an event of the next tick would
  /// have said who has not answered.
  std::int64_t last_whole() const { return published_ - (unanswered_ == published_ ? 1 : 0); }
  /// The tick that agent `id`'s current command answered; -1: the agent has given none.
  std::int64_t answered(int id) const { return answered_[static_cast<std::size_t>(id - 1)]; }

 private:
  bool AwaitsPublication() const { return published_ < tick_; }
  /// True while the states of the world's tick wait for the recorder.
  bool AwaitsRecorder() const { return AwaitsPublication() && recorded_rows_ <= tick_ - rules_.recorder_window; }
  /// Whether the world's tick may be published without a look at the clock.
  bool IsOpen() const { return rules_.realtime || gate_.IsOpen(); }
  /// Notes that the world's tick is published.
  void NotePublished();
  /// Notes that the world's tick is published, and returns true, if it is not published yet and neither the recorder
  /// nor the gate prevents it.
  bool Publish();
  /// All agents that are waited for have answered the newest tick.
  Actions EndOfAnswers(bool stop_requested);
  /// Moves on to the next tick.
  Actions Step();
  /// Look() at a tick that waits for all commands, or for the recorder: fails if nothing has moved for too long.
  Turn Watch(Time now);
  /// Whether it is time to ask again for the answers to the newest tick: in lockstep, which waits for them.
  bool AsksAgain(Time now);
  /// Whether it does not matter yet who has answered the newest tick: no other is asked for, in lockstep.
  bool Rests(bool stop_requested) const;
  /// Look() in lockstep at a tick whose states wait for nothing but the gate.
  Turn LookAtGate(Time now, bool stop_requested);
  /// Look() in real time between the first and the last tick.
  Turn LookAtClock(Time now, bool stop_requested);
  /// Look() in real time when the next tick is due: ends this one with the commands held.
  Turn EndTick(Time due, Time now, bool stop_requested);
  /// Agents whose command is older than run.agent_timeout_s.
  std::vector<int> HeldTooLong() const;
  /// "tick 12: no command from agents 2, 5 within run.agent_timeout_s = 5.0 s".
  std::string NoCommandFrom(const std::vector<int>& agents) const;
  /// `turn` with the failure that agents have not answered this tick, or that the recorder is late.
  Turn WithFailure(Turn turn) const;

  const Rules rules_;
  bool running_ = false;
  bool timed_ = false;  // real time: the gate has been asked when a tick is due
  bool paced_ = false;  // real time: from the first tick's answers to the last tick, the gate ends ticks
  bool finished_ = false;
  bool held_ = false;
  std::int64_t tick_ = 0;  // the world's tick
  std::int64_t published_ = -1;
  std::int64_t unanswered_ = -2;  // the newest tick that a lost agent has left unanswered
  std::int64_t recorded_rows_ = 0;
  TickBarrier barrier_;                 // waits for the newest tick published
  std::vector<std::int64_t> answered_;  // by id - 1: the last tick answered
  ProgressWatch watch_;
  std::int64_t asked_ = -1;                          // the tick whose answers Watch() awaits,
  Time asked_at_;                                    // since when, or when they were asked for again,
  std::chrono::steady_clock::duration ask_after_{};  // and after which time they will be
  TickGate gate_;
};

}  // namespace mascot
