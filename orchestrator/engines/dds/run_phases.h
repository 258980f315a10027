#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "physics_server/process/progress_watch.h"

namespace mascot {

/// How a process ended, and why: the first error among the last lines that it printed is the headline, the other lines
/// follow. The error may name another process, such as an agent that does not answer.
std::string StoryOfEnd(const std::string& process, const std::string& end, std::vector<std::string> lines);

/// The orchestrator's decisions during a run over DDS: when the recorder is ready, when and why the run is over, for
/// which process to wait and for how long.
///
/// Without DDS, processes, clock and files: events, the time and the state of the run are passed in. The caller carries
/// out the returned Actions at once.
class RunPhases {
 public:
  using Time = std::chrono::steady_clock::time_point;

  enum class Phase {
    kStarting,    ///< until the first sample of a tick has come
    kFlying,      ///< until the physics server is done
    kDraining,    ///< the server is done; samples may still be on their way to the recorder
    kCollecting,  ///< the run is over, for whatever reason; the remaining rows are recorded
    kReporting,   ///< after a run that did not end in order: waiting for the server's report of what it measured
    kEnding,      ///< every process is told to end
  };

  struct Rules {
    double start_timeout_s = 0;  ///< run.start_timeout_s
    double agent_timeout_s = 0;  ///< run.agent_timeout_s
    double period_s = 0;         ///< wall-clock time between two ticks in real time; 0: lockstep

    std::function<std::string()> violation;  ///< how the DDS endpoints differ from the graph; empty: they do not
    std::function<std::string()> missing;    ///< what the start still waits for
    std::function<std::string()> lacking;    ///< what the recording waits for; empty: for nothing but the next tick
    /// Whether the start waits for people, who let vehicles take off: that takes as long as it takes.
    std::function<bool()> waits_for_people = [] { return false; };
    /// Whether the exit of this process is the loss of its agents, or of its vehicle, with which the run goes on.
    std::function<bool(const std::string& process)> is_loss;
    /// The last lines that a child printed.
    std::function<std::vector<std::string>(const std::string& process)> last_lines;
  };

  /// A child process that has ended.
  struct Exit {
    std::string process;
    std::optional<int> code;  ///< nothing: a signal killed it
    std::string text;         ///< how it ended: "exited with code 3"
  };

  /// The state of the run at one moment.
  struct View {
    /// Every endpoint of the graph is discovered, the recorder has every writer, and every process the experiment.
    bool everybody_found = false;
    std::int64_t newest_tick = -1;               ///< newest tick with a sample; -1: none
    std::int64_t rows = 0;                       ///< rows recorded
    bool gave_up = false;                        ///< incomplete rows were recorded too, because gives_up()
    std::optional<std::int64_t> last_tick = {};  ///< last tick of the physics server, once it is done
    std::int64_t server_words = 0;               ///< statuses of the physics server: while paused, its signs of life
    bool reported = false;                       ///< the physics server has sent its last status, with what it measured
  };

  struct Actions {
    bool say_ready = false;    ///< tell the server (again) that the recorder is ready
    bool ask_to_stop = false;  ///< ask the server to stop in order
    bool ask_to_end = false;   ///< ask every process to end
    bool kill = false;         ///< kill every child
    bool operator==(const Actions&) const = default;
  };

  RunPhases(Rules rules, Time launched);

  /// Call it when SIGINT, SIGTERM or SIGHUP has come. The first stops the run in order, the second kills the children;
  /// during kReporting, a signal only ends that wait.
  Actions OnSignal(int signal, Time now);
  /// Call it when a user asks for the end of the run: as the first signal, but the run counts as one that has ended by
  /// itself.
  Actions OnRequestToStop(Time now);
  /// Call it when children have exited by themselves. Before the run is over, that is a failure, or a loss.
  void OnExits(const std::vector<Exit>& exits, Time now);
  /// The processes whose agents are lost since the last call, with how they ended and why.
  std::vector<std::pair<std::string, std::string>> TakeLosses() { return std::exchange(losses_, {}); }
  /// Makes the run fail, because of `why`. Only the first failure is kept; if the DDS endpoints differ from the graph,
  /// that difference is given as the reason instead.
  void Fail(const std::string& why);
  /// Call it when the DDS endpoints differ from the graph, as `violation` says: the run fails.
  void OnViolation(const std::string& violation);
  /// Call it regularly, and whenever something has happened: it goes on to the next phase when it is time.
  Actions Look(const View& view, Time now);
  /// Call it when every row that came has been recorded: the collecting is done.
  Actions Collected(const View& view, Time now);

  Phase phase() const { return phase_; }
  /// Whether rows that lack commands are to be recorded now: no more samples are expected.
  bool gives_up(Time now) const { return drain_deadline_ && now > *drain_deadline_; }
  /// Whether the run has neither failed nor been stopped early.
  bool in_order() const { return failure_.empty() && signal_ == 0; }
  const std::string& failure() const { return failure_; }
  /// The signal that stopped the run early; 0: none.
  int signal() const { return signal_; }
  /// Whether every endpoint was discovered before the first tick.
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
  bool server_exited_ = false;  // by itself, with an exit code: its last status may still be on its way
  bool server_silent_ = false;  // killed, or hangs: no more statuses are expected
  std::vector<Exit> exits_;     // not judged yet (JudgeExits)
  std::vector<std::pair<std::string, std::string>> losses_;  // TakeLosses()
  std::int64_t rows_ = 0;                                    // rows recorded at the last Look()
  std::optional<Time> exits_deadline_, stop_deadline_, drain_deadline_, report_deadline_;
  ProgressWatch watch_;
};

}  // namespace mascot
