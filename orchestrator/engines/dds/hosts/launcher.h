#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/peers.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/dds/hosts/host_words.h"
#include "orchestrator/recording/run_folder.h"
#include "system/child_logs.h"
#include "system/children.h"

namespace mascot {

class OutsideFields;

/// The other hosts of a run (`[[hosts]]`): starts `orchestrator host` on each by its launch command, tells it what to
/// start, and hears what its processes print and how they end. A connection that ends is a child that has ended, called
/// host_NAME, or `hosts` for those that were started together.
class Launcher {
 public:
  struct Rules {
    double start_timeout_s = 0;
    double silence_s = 0;  ///< a host from which nothing is heard for this time is lost
    /// Whether the run goes on without a host that is lost: its processes have ended then (TakeEnded()).
    std::function<bool()> goes_on = [] { return false; };
    /// What a host shall do. `our_address` is the address at which it reaches this machine.
    std::function<HostJob(const HostConfig& host, const std::string& our_address)> job;
  };

  /// A process on another host has ended, or is lost with its host.
  struct Ended {
    std::string process;
    std::optional<int> code;  ///< nothing: a signal killed it, or nobody knows
    std::string text;         ///< "exited with code 3 on lab1", "was on host lab2, which has not been heard of for 3 s"
  };

  /// All but `rules` must outlive this object.
  Launcher(const Experiment& experiment, const RunFolder& folder, Rules rules, Children& children, ChildLogs& logs,
           Peers& peers);
  ~Launcher();
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// Starts the launch commands. Throws std::runtime_error if one cannot be started.
  void Start();
  /// Reads the messages of the hosts, and sends a sign of life. Call it at least ten times a second. Returns whether
  /// there was a message. Throws std::runtime_error if a host may not be of the run (WhyNotTogether()), cannot do its
  /// job, or is lost and the run does not go on without it.
  bool Pump();
  /// A child of this host has ended. Returns whether it was the connection to hosts without which the run goes on.
  bool OnExit(const Exit& exit);
  /// The processes on other hosts that have ended, or were lost, since the last call.
  std::vector<Ended> TakeEnded();
  /// Tells the hosts to kill their processes.
  void Kill();
  /// Tells the hosts to leave when their processes have ended. Returns whether any host has answered.
  bool End();

 private:
  struct Connection;
  struct Remote;
  using Time = std::chrono::steady_clock::time_point;

  Connection& Connect(const HostConfig& host);
  void Hear(const Connection& connection, const std::string& line);
  void Obey(Remote& remote, const HostWords& words);
  void TakeWordOf(Remote& remote, const std::string& kind, OutsideFields& fields);
  void Greet(Remote& remote, const HostHello& hello);
  void CheckPids(const Remote& remote) const;
  void CheckSilence(Remote& remote);
  void Lose(Remote& remote, const std::string& how);
  void TellAll(const HostWords& words);

  const Experiment& experiment_;
  const RunFolder& folder_;
  const Rules rules_;
  Children& children_;
  ChildLogs& logs_;
  Peers& peers_;
  std::vector<std::unique_ptr<Connection>> connections_;
  std::vector<std::unique_ptr<Remote>> remotes_;
  std::vector<Ended> ended_;
  Time next_sign_{};
  bool ending_ = false;
};

}  // namespace mascot
