#pragma once

#include <stop_token>
#include <string>
#include <thread>

#include "experiment/experiment.h"
#include "orchestrator/control/request_queue.h"
#include "orchestrator/control/run_requests.h"
#include "system/local_socket.h"

namespace mascot {

/// The beginning of the name of a run's socket. The process id of the run follows and, if another process has that
/// name, "-" and a random number.
inline constexpr std::string_view kRunSocketPrefix = "mascot-run-";

/// The socket through which other programs of this machine (`orchestrator ps` and `send`) reach a run. Its name is
/// abstract (unix(7)), in no folder, so that nothing of it is left when the run ends.
///
/// A client sends one JSON object in one line, within 2 s, and gets one back: to {"who": ...} what the run is and how
/// far it has come; to any other object, which is a request (request.h), {"granted": bool, "words": text}. The run
/// answers only clients of its own user and of root; it closes the connections of others before it reads a byte. A
/// client that sends no line in time is dropped; a request that is wrong is refused in words.
class RunSocket {
 public:
  /// Listens from now on, in a thread of its own, until this object is destroyed. `folder` is that of the results,
  /// `engine` "dds" or "inprocess", `page` the address of the run's page, or empty. `experiment` and `requests` must
  /// outlive this object. Throws std::runtime_error if there can be no such socket.
  RunSocket(const Experiment& experiment, const std::string& folder, const std::string& engine, const std::string& page,
            RunRequests& requests);
  ~RunSocket();
  RunSocket(const RunSocket&) = delete;
  RunSocket& operator=(const RunSocket&) = delete;

 private:
  void Listen(const std::stop_token& over);
  void Serve(Descriptor client);
  std::string WhoWeAre() const;

  const Experiment& experiment_;
  const std::string folder_, engine_, page_;
  RunRequests& requests_;
  const Descriptor socket_;
  RequestQueue request_queue_;  // asks in a thread of its own, so that a slow request keeps no other client waiting
  std::jthread thread_;
};

}  // namespace mascot
