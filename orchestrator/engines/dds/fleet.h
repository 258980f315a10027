#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/flight_phase.h"
#include "bus/wire.h"
#include "experiment/experiment.h"

namespace mascot {

/// What is known of one vehicle.
struct VehicleState {
  FlightPhase phase = FlightPhase::kAbsent;
  std::string release = {};            ///< of its software; empty: nothing has been heard of it
  std::optional<double> battery = {};  ///< share that is left, 0 to 1
};
/// The vehicles of a run, as the orchestrator knows and asks them: it takes what their processes say, and decides what
/// follows for the others. No DDS and no clock.
class Fleet {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// What a process of a vehicle is asked, for these agents.
  struct Order {
    Ask ask = Ask::kLand;
    std::vector<std::uint32_t> agents = {};
    std::string reason = {};
    bool operator==(const Order&) const = default;
  };

  explicit Fleet(const Experiment& experiment);

  void Take(const mascot_msgs::msg::VehicleStatus& status);
  /// The process of a vehicle has ended, how: its autopilot decides now.
  void OnProcessEnd(int agent, const std::string& how);
  /// What has happened since the last call.
  std::vector<VehicleNews> TakeNews();

  // What people want. Each returns what is answered to them.
  std::string Start();
  /// `agent`: 0 for all.
  std::string Land(int agent, const std::string& reason);
  std::string StopMotors(int agent, const std::string& reason);
  /// What is to be asked now.
  std::vector<Order> Orders(Time now);

  bool empty() const { return vehicles_.empty(); }
  /// All are there, on the ground.
  bool AreFound() const;
  /// All hold at the starts of their agents, or fly.
  bool AreReady() const;
  /// None is in the air, or on its way up: nothing is sent to any.
  bool AreDown() const;
  /// What a run that has not begun waits for, for people: "vehicles 1, 2 are found, vehicle 3 is armed".
  std::string Awaited() const;
  /// Why the run cannot begin any more, for people: "vehicle 3 is lost". Empty: it can. No vehicle starts twice.
  std::string WhyNotToBegin() const;
  /// Where all are in their flights: "1 flying, 3 landing".
  std::string Phases() const;
  VehicleState Of(int agent) const { return vehicles_.at(agent).state; }

 private:
  struct Vehicle {
    VehicleState state = {};
    std::uint64_t number = 0;  // of its newest words
    OnVehicleLoss on_loss = OnVehicleLoss::kLand;
    bool has_process = true, has_flown = false;
  };
  void OnLoss(int agent);
  std::string InPhases(bool (*these)(FlightPhase)) const;
  std::vector<std::uint32_t> Flying() const;

  std::map<int, Vehicle> vehicles_;
  std::vector<VehicleNews> news_;
  std::vector<Order> new_orders_, repeated_;
  Time repeat_at_ = {};
};

}  // namespace mascot
