#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "physics_server/progress_watch.h"

namespace mascot {

/// What the orchestrator decides in the course of a run over DDS: when the recorder is ready, when the run is over and
/// why, who is waited for and for how long.
///
/// It has no wire, process, clock or file: it is told what happened and, when it looks, what time it is and what there
/// is. Each answer is what the caller does at once.
class RunPhases {
 public:
  using Time = std::chrono::steady_clock::time_point;

  enum class Phase {
    kStarting,    ///< until the first state has come
    kFlying,      ///< until the physics server is done
    kDraining,    ///< the server is done; rows may still be on their way to the recorder
    kCollecting,  ///< the run is over, for whatever reason: what is there is written
    kReporting,   ///< if it did not end in order, the server is waited for, to say what it measured
    kEnding,      ///< every process is told to end
  };

  struct Rules {
    double start_timeout_s = 0;  ///< run.start_timeout_s
    double agent_timeout_s = 0;  ///< run.agent_timeout_s
    double period_s = 0;         ///< of the wall clock between two ticks in real time; 0: lockstep

    std::function<std::string()> violation;  ///< how the wire differs from the graph; empty: it does not
    std::function<std::string()> missing;    ///< for whom the start still waits
    std::function<std::vector<std::string>(const std::string& process)> last_lines;  ///< that a child printed
  };

  /// A child process that has ended.
  struct Exit {
    std::string process;
    std::optional<int> code;  ///< nothing: a signal killed it
    std::string text;         ///< how it ended: "exited with code 3"
  };

  /// What there is at a moment.
  struct View {
    bool everybody_found = false;                ///< the wire is as the graph says, and the recorder has every writer
    std::int64_t newest_tick = -1;               ///< of which a state has come; -1: none
    std::int64_t rows = 0;                       ///< recorded
    bool gave_up = false;                        ///< incomplete rows were recorded, too, as gives_up() asked
    std::optional<std::int64_t> last_tick = {};  ///< the physics server is done, with this tick
    bool reported = false;                       ///< the physics server has said what it measured, and will say no more
  };

  struct Actions {
    bool say_ready = false;    ///< tell the server that the recorder is ready; it may have been told
    bool ask_to_stop = false;  ///< ask the server to stop in order
    bool ask_to_end = false;   ///< ask every process to end
    bool kill = false;         ///< kill every child
    bool operator==(const Actions&) const = default;
  };

  RunPhases(Rules rules, Time launched);

  /// SIGINT, SIGTERM, ... came. The first stops the run in order, the second at once.
  Actions OnSignal(int signal, Time now);
  /// Children have ended by themselves, which none should before the run is over.
  void OnExits(const std::vector<Exit>& exits, Time now);
  /// Something that the run cannot do without has failed. The first failure is why the run failed; where somebody is on
  /// the wire who should not be, that is why, whoever stumbles over it first.
  void Fail(const std::string& why);
  /// The wire differs from the graph, in this way.
  void OnViolation(const std::string& violation);
  /// Time has gone by, or something has come.
  Actions Look(const View& view, Time now);
  /// Every row that there is has been written.
  Actions Collected(const View& view, Time now);

  Phase phase() const { return phase_; }
  /// Rows that lack commands are worth recording now: nothing more will come.
  bool gives_up(Time now) const { return drain_deadline_ && now > *drain_deadline_; }
  /// Neither failed nor stopped early.
  bool in_order() const { return failure_.empty() && signal_ == 0; }
  const std::string& failure() const { return failure_; }
  /// The signal that stopped the run early; 0: none.
  int signal() const { return signal_; }
  /// Before the first state everybody was found on the wire.
  bool found_everybody() const { return found_everybody_; }

 private:
  bool IsOver() const { return phase_ >= Phase::kCollecting; }
  void Finish();
  void Note(const std::string& why);
  void JudgeExits();
  void LookAtDraining(const View& view, Time now);
  void LookAtDeadlines(const View& view, Time now);
  void LookAtReport(const View& view, Time now);

  const Rules rules_;
  const Time launched_;
  Phase phase_ = Phase::kStarting;
  std::string failure_;
  int signal_ = 0;
  bool found_everybody_ = false;
  bool server_exited_ = false;  // by itself: what it said last may still be on its way
  bool server_silent_ = false;  // it was killed, or hangs: it will not say anything more
  std::vector<Exit> exits_;     // not judged yet
  std::int64_t rows_ = 0;       // recorded at the last look
  std::optional<Time> exits_deadline_, stop_deadline_, drain_deadline_, report_deadline_;
  ProgressWatch watch_;
};

}  // namespace mascot
