#pragma once

#include <stop_token>
#include <string>
#include <thread>

#include "experiment/experiment.h"
#include "orchestrator/control/asker.h"
#include "orchestrator/control/helm.h"
#include "system/local_socket.h"

namespace mascot {

/// How the name of a run's socket begins; its process id follows and, if somebody else has that name, "-" and a random
/// number.
inline constexpr std::string_view kRunSocketPrefix = "mascot-run-";

/// Where other programs of this machine reach a run: a socket with an abstract name (unix(7)), in no folder, so that
/// nothing of it is left. It speaks to its own user and to root only (others are gone before a byte of theirs is read):
/// one JSON object in a line comes in, within 2 s, and one goes out.
class RunSocket {
 public:
  /// Listens from now on. `experiment` and `helm` must outlive this object. Throws std::runtime_error.
  RunSocket(const Experiment& experiment, const std::string& folder, const std::string& engine, const std::string& page,
            Helm& helm);
  ~RunSocket();
  RunSocket(const RunSocket&) = delete;
  RunSocket& operator=(const RunSocket&) = delete;

 private:
  void Listen(const std::stop_token& over);
  void Serve(Descriptor client);
  std::string WhoWeAre() const;

  const Experiment& experiment_;
  const std::string folder_, engine_, page_;
  Helm& helm_;
  const Descriptor socket_;
  Asker asker_;  // so that a wish that takes long keeps nobody else waiting
  std::jthread thread_;
};

}  // namespace mascot
