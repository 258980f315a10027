#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "bus/lifecycle.h"
#include "bus/outside_domain.h"
#include "bus/wire.h"
#include "experiment/experiment.h"
#include "vehicle/autopilot.h"
#include "vehicle/pilot.h"
#include "vehicle/process/command_reader.h"

namespace mascot {

/// Flies the vehicle of one agent in a run: it tells the physics server what the vehicle measures, turns the agent's
/// commands into set-points, and says how the flight goes. When this object goes, the vehicle gets nothing any more,
/// and its autopilot decides.
class VehicleNode {
 public:
  /// `outside`: of a participant in the vehicle's domain. All but that must outlive this object.
  VehicleNode(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, int agent,
              const OutsideDomain::Options& outside);

  /// Throws what Lifecycle::Wait() throws.
  [[noreturn]] void Run();

 private:
  using Time = Pilot::Time;
  bool Matched() const;
  void OnCommand(std::int64_t tick, const Eigen::Vector3d& a_W);
  void OnRequest(const mascot_msgs::msg::Request& request);
  /// Does what is due.
  void Turn();
  void Say(const VehicleReport& report, Time now);

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  const int agent_;
  std::mutex mutex_;  // guards pilot_ and is_commanded_
  Pilot pilot_;
  bool is_commanded_ = false;  // since the last set-point
  std::unique_ptr<Autopilot> autopilot_;
  Writer<StateType> motions_;
  Writer<VehicleStatusType> statuses_;
  CommandReader commands_;
  Reader<RequestType> requests_;
  Time published_at_ = {}, streamed_at_ = {}, said_at_ = {};
  mascot_msgs::msg::AgentState motion_;
  mascot_msgs::msg::VehicleStatus status_;
};

}  // namespace mascot
