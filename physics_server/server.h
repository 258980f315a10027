#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "bus/lifecycle.h"
#include "experiment/experiment.h"
#include "physics_server/pace_meter.h"
#include "physics_server/start_roll.h"
#include "physics_server/tick_protocol.h"
#include "physics_server/world.h"

namespace mascot {

/// The tick loop on the wire: publish every agent's state, gather every agent's command, step the world.
/// In lockstep the last command of a tick to arrive carries the world to the next, in the thread that
/// received it; in real time the calling thread paces the ticks and commands are held when late.
/// StartRoll and TickProtocol decide what is done when; Server does it.
class Server {
 public:
  Server(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment);

  /// Waits until every endpoint is matched and every agent and the recorder are ready; runs all ticks;
  /// returns when the last command is gathered or a STOP came. Throws std::runtime_error naming who was
  /// late, or Ended.
  void Run();

 private:
  void AwaitEveryone();
  void BeginRollCall();
  /// Throws when the time is up.
  StartRoll::Next LookAtRoll();
  /// Every process says again how far it is, for those that did not hear it.
  void AskForReports();
  bool Matched() const;
  void RunTicks();
  void Start();
  /// Does what it is time for. Returns when to look again; nothing: the run is finished. Throws naming who was late.
  std::optional<TickProtocol::Time> Look();
  void Report();

  void OnCommand(int id, const mascot_msgs::msg::AgentCommand& command);
  void OnStatus(const mascot_msgs::msg::Status& status);
  // The functions below are called with mutex_ held.
  void Do(const TickProtocol::Actions& actions);
  void Publish();
  /// Publishes to each agent those of samples_ that it may hear.
  void PublishBundles();
  /// Notes how old the commands are that the world is stepped with.
  void MeasureCommands();

  Lifecycle& lifecycle_;
  const Experiment& experiment_;

  std::mutex mutex_;  // guards all below but the endpoints
  StartRoll roll_;
  TickProtocol ticks_;
  World world_;
  std::vector<Actuation> commands_;  // by id - 1: what the world is stepped with
  PaceMeter pace_;

  std::vector<std::unique_ptr<Writer<StateType>>> states_;
  std::vector<int> state_readers_;                            // by id - 1: how many each must find
  std::vector<std::unique_ptr<Writer<BundleType>>> bundles_;  // none: states are delivered one by one
  std::vector<mascot_msgs::msg::AgentState> samples_;         // what was published last, by id - 1
  mascot_msgs::msg::AgentBundle bundle_;
  Writer<ClockType> clock_;
  Writer<RequestType> requests_;
  std::vector<std::unique_ptr<Reader<CommandType>>> command_readers_;
  Reader<StatusType> status_reader_;
};

}  // namespace mascot
