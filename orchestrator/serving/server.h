#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "orchestrator/live/server/address.h"
#include "orchestrator/serving/conversation.h"
#include "orchestrator/serving/team_service.h"

namespace mascot {

/// Limits of a server of `orchestrator serve`.
struct ServeLimits {
  std::size_t clients = 16;            ///< a further one is told so, and dropped
  Conversation::Limits messages = {};  ///< how long they may be
  std::chrono::seconds hello{5};       ///< time for hello to arrive
};

/// Serves a team by TCP (docs/serve.md). The first message of a client must be hello: a page in a browser, which can
/// send nothing but HTTP, is dropped unheard. One client alone steps the team, the first that asks to; when it is gone,
/// the next that asks does. A client gets its next answer only when it has taken the one before, so that a slow one
/// makes nobody else wait.
class ServeSocket {
 public:
  /// Listens from now on. Throws ConfigError if the port is taken, or the address is none of this machine.
  ServeSocket(const LiveAddress& at, TeamService& team, ServeLimits limits = {});
  ~ServeSocket();
  ServeSocket(const ServeSocket&) = delete;
  ServeSocket& operator=(const ServeSocket&) = delete;

  /// "127.0.0.1:8770"
  std::string address() const;
  /// Serves in this thread until `goes_on`, which is asked ten times a second, returns false. With `once`, also until
  /// the client that steps the team is gone, or no client has asked to step it for `patience`.
  void Run(const std::function<bool()>& goes_on, bool once, std::chrono::seconds patience);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot
