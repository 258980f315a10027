#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "orchestrator/control/run_control.h"

namespace mascot {

/// What `orchestrator ps` says of a run that is alive.
struct RunningRun {
  enum class Voice {
    kAnswers,
    /// The run is stopped (SIGSTOP, Ctrl-Z); of runs of this kind and the next ones, only process and user are known.
    kStopped,
    kSilent,    ///< the run does not answer
    kOfOthers,  ///< the run is another user's, and is not asked
  };
  pid_t process = 0;
  std::string user;
  Voice voice = Voice::kOfOthers;
  std::string name, folder, engine;
  std::string page;  ///< address of its page; empty: none
  int agents = 0;
  int domain = -1;         ///< DDS domain; -1: none
  std::int64_t tick = -1;  ///< newest one recorded; -1: none
  double t_s = 0, duration_s = 0;
  bool paused = false;
  double pace = 0;       ///< simulated seconds a second; 0: as fast as it goes
  std::string vehicles;  ///< where they are in their flights: "1 flying, 3 landing"; empty: there are none

  bool is_ours() const { return voice != Voice::kOfOthers; }
};

// A run is found by the name of its socket, which any process can take. The kernel therefore says first which process
// listens there: it must be the process whose id is in the name, of our user (or of any user, if we are root and the
// process runs this very program). Other processes are not even asked. Answers are checked like messages from
// strangers.

/// The runs that are alive on this machine, in this network namespace, by process id. A run that is stopped costs a
/// quarter of a second, a run that is silent 5 s.
std::vector<RunningRun> RunsAlive();
/// These runs as a JSON array.
std::string RunsJson(const std::vector<RunningRun>& runs);
/// Asks a run, and waits at most 60 s for its answer. The answer is not granted, with the reason, also if the run is
/// gone, stopped or another user's.
Answer AskRun(pid_t process, const Request& request);

}  // namespace mascot
