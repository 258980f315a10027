#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "physics_server/progress_watch.h"
#include "physics_server/tick_barrier.h"
#include "physics_server/timetable.h"

namespace mascot {

/// The server's part in the exchange of a run: when states are published, which commands count, when the world steps,
/// when nobody is waited for any longer. In lockstep a tick ends with the last agent's command. In real time it ends
/// when the next is due, with commands held that are late; only the first and the last wait for every command.
///
/// It has no world, wire, clock or lock: it is told what came, and when it looks, what time it is. Each event is
/// answered with what the caller does at once, before the next event.
class TickProtocol {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Rules {
    int agents = 0;
    std::int64_t last_tick = 0;
    std::optional<double> period_s = {};  ///< of the wall clock between two ticks in real time; none: lockstep
    double agent_timeout_s = 0;           ///< run.agent_timeout_s
    std::int64_t recorder_window = 0;     ///< tick k is published once the recorder has tick k - recorder_window
  };

  /// What the caller does, in this order.
  struct Actions {
    bool take = false;     ///< hold the command that came, in place of the agent's last
    bool step = false;     ///< step the world to its next tick, with the commands held
    bool publish = false;  ///< publish the states of the world's tick
    bool wake = false;     ///< make the loop Look without delay
    bool operator==(const Actions&) const = default;
  };

  /// What a look at the clock leads to.
  struct Turn {
    Actions actions = {};
    std::optional<Time> due = {};         ///< if a tick of real time ends now: when the next was due
    std::optional<Time> look_again = {};  ///< when to Look at the latest; none: the run is over
    std::string failure = {};             ///< why the run has failed; empty: it has not
  };

  explicit TickProtocol(const Rules& rules);

  /// Everybody is ready. Before this, commands are ignored and nothing is published.
  Actions Start();
  /// The recorder has confirmed all rows before row `rows`.
  Actions OnRecorded(std::int64_t rows);
  /// Agent `id` (1..N) answered `tick`. Only a command that answers a later tick than the agent's last counts, and none
  /// to a tick that is not published.
  Actions OnCommand(int id, std::int64_t tick, bool stop_requested);
  /// The loop's part, from Start() on: ends the ticks of real time that are due, and finds out who is late.
  Turn Look(Time now, bool stop_requested);

  /// The last tick is answered, or a requested stop has taken effect. From then on no command counts and nothing is
  /// published.
  bool finished() const { return finished_; }
  /// The newest tick published; -1: none.
  std::int64_t published() const { return published_; }
  /// The tick that the command held of agent `id` answered; -1: it has given none.
  std::int64_t answered(int id) const { return answered_[static_cast<std::size_t>(id - 1)]; }

 private:
  bool IsRealtime() const { return rules_.period_s.has_value(); }
  /// The next states wait for the recorder.
  bool AwaitsRecorder() const { return published_ < tick_; }
  /// The world's tick counts as published, unless it is already or the recorder is too far behind.
  bool Publish();
  Actions Step();
  /// The Turn of a tick that waits for all commands, or for the recorder: fails if nothing has moved for too long.
  Turn Watch(Time now);
  /// The Turn of a tick of real time that ends, with the commands held.
  Turn EndTick(Time due, Time now, bool stop_requested);
  /// A command is older than an agent may be silent.
  bool HoldsTooLong() const;
  /// "tick 12: no command from agents 2, 5 within run.agent_timeout_s = 5.0 s".
  std::string WhoIsLate() const;

  const Rules rules_;
  bool running_ = false;
  bool paced_ = false;  // by the timetable: in real time, between the first tick's answers and the last tick
  bool finished_ = false;
  std::int64_t tick_ = 0;  // the world's
  std::int64_t published_ = -1;
  std::int64_t recorded_rows_ = 0;
  TickBarrier barrier_;                 // waits for the newest tick published
  std::vector<std::int64_t> answered_;  // by id - 1
  ProgressWatch watch_;
  std::optional<Timetable> timetable_;  // from the first Look that paces
};

}  // namespace mascot
