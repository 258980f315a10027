#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bus/local_socket.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/helm.h"

namespace mascot {

/// What `orchestrator ps` says of a run that is alive.
struct RunningRun {
  pid_t process = 0;
  std::string user;
  bool is_ours = false;  ///< its user may be asked by us; else all that follows is unknown
  std::string name, folder, engine;
  std::string page;  ///< address of its page; empty: none
  int agents = 0;
  int domain = -1;         ///< DDS domain; -1: none
  std::int64_t tick = -1;  ///< newest one recorded; -1: none
  double t_s = 0, duration_s = 0;
  bool paused = false;
  double pace = 0;  ///< simulated seconds a second; 0: as fast as it goes
};

/// Where other programs of this machine reach a run: a socket with an abstract name (unix(7)), in no folder, so that
/// nothing of it is left. It speaks to its own user and to root only: one JSON object in a line comes in, one goes out.
class RunSocket {
 public:
  /// Listens from now on. `experiment` and `helm` must outlive this object. Throws std::runtime_error.
  RunSocket(const Experiment& experiment, const std::string& folder, const std::string& engine, const std::string& page,
            Helm& helm);
  ~RunSocket();
  RunSocket(const RunSocket&) = delete;
  RunSocket& operator=(const RunSocket&) = delete;

 private:
  void Listen();
  void Serve(Descriptor client);
  std::string AnswerTo(const std::string& request);

  const Experiment& experiment_;
  const std::string folder_, engine_, page_;
  Helm& helm_;
  const Descriptor socket_;
  std::jthread thread_;
};

/// The runs that are alive on this machine, in this network namespace, by process id.
std::vector<RunningRun> RunsAlive();
/// The same as a JSON array, of which nothing but process and user is known for runs of others.
std::string RunsJson(const std::vector<RunningRun>& runs);
/// Asks a run. Nothing: it is gone, or ended before it answered.
std::optional<Answer> AskRun(pid_t process, const Wish& wish);

}  // namespace mascot
