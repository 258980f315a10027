#include "orchestrator/engines/dds/fleet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace mascot {
namespace {

using namespace std::chrono_literals;

constexpr auto kRepeatEvery = 200ms;

bool IsReady(FlightPhase phase) { return phase == FlightPhase::kReady || phase == FlightPhase::kFlying; }

bool IsUp(FlightPhase phase) { return phase >= FlightPhase::kStreaming && phase <= FlightPhase::kLanding; }

std::string VehiclesText(const std::vector<std::uint32_t>& agents) {
  return fmt::format("vehicle{} {}", agents.size() == 1 ? "" : "s", fmt::join(agents, ", "));
}

}  // namespace

Fleet::Fleet(const Experiment& experiment) {
  for (const int id : AgentsWithVehicles(experiment)) vehicles_[id].on_loss = experiment.agent(id).vehicle->on_loss;
}

void Fleet::Take(const mascot_msgs::msg::VehicleStatus& status) {
  const auto found = vehicles_.find(static_cast<int>(status.agent()));
  if (found == vehicles_.end() || status.phase() > static_cast<std::uint8_t>(FlightPhase::kLost))
    throw std::runtime_error(fmt::format("a status of vehicle {} in phase {}, which there is not", status.agent(),
                                         static_cast<int>(status.phase())));
  Vehicle& vehicle = found->second;
  if (!vehicle.has_process) return;
  vehicle.state.phase = static_cast<FlightPhase>(status.phase());
  vehicle.state.release = status.release().to_string();
  vehicle.state.battery = std::isnan(status.battery()) ? std::nullopt : std::optional(status.battery());
  vehicle.has_flown = vehicle.has_flown || vehicle.state.phase >= FlightPhase::kArmed;
  if (status.number() <= vehicle.number) return;
  vehicle.number = status.number();
  news_.push_back({found->first, vehicle.state.phase, status.words().to_string()});
  if (vehicle.state.phase == FlightPhase::kLost) OnLoss(found->first);
}

void Fleet::OnProcessEnd(int agent, const std::string& how) {
  Vehicle& vehicle = vehicles_.at(agent);
  if (!std::exchange(vehicle.has_process, false)) return;
  const bool was_up = IsUp(vehicle.state.phase);
  vehicle.state.phase = FlightPhase::kLost;
  news_.push_back({agent, FlightPhase::kLost, "lost: its process " + how});
  if (was_up) OnLoss(agent);
}

/// Asks the vehicles to land whose on_loss says so, because another one is lost.
void Fleet::OnLoss(int agent) {
  std::vector<std::uint32_t> others;
  for (const auto& [id, vehicle] : vehicles_)
    if (id != agent && vehicle.on_loss == OnVehicleLoss::kLand && IsUp(vehicle.state.phase))
      others.push_back(static_cast<std::uint32_t>(id));
  if (!others.empty()) new_orders_.push_back({Ask::kLand, others, fmt::format("vehicle {} is lost", agent)});
}

std::vector<VehicleNews> Fleet::TakeNews() { return std::exchange(news_, {}); }

std::string Fleet::Start() {
  std::vector<std::uint32_t> found, absent;
  for (const auto& [id, vehicle] : vehicles_) {
    const auto agent = static_cast<std::uint32_t>(id);
    if (vehicle.state.phase == FlightPhase::kFound) found.push_back(agent);
    if (vehicle.state.phase == FlightPhase::kAbsent || vehicle.state.phase == FlightPhase::kLost)
      absent.push_back(agent);
  }
  if (!absent.empty())
    throw std::invalid_argument("start: expected all vehicles to be there, got none of " + VehiclesText(absent));
  if (found.empty()) throw std::invalid_argument("start: expected vehicles that stand on the ground, got none");
  new_orders_.push_back({Ask::kStart, found, "asked to start"});
  return VehiclesText(found) + " start";
}

std::vector<std::uint32_t> Fleet::Flying() const {
  std::vector<std::uint32_t> up;
  for (const auto& [id, vehicle] : vehicles_)
    if (IsUp(vehicle.state.phase)) up.push_back(static_cast<std::uint32_t>(id));
  return up;
}

std::string Fleet::Land(int agent, const std::string& reason) {
  std::vector<std::uint32_t> up = Flying();
  if (agent != 0) std::erase_if(up, [agent](std::uint32_t id) { return std::cmp_not_equal(id, agent); });
  if (up.empty()) throw std::invalid_argument("land: expected a vehicle in the air, got none");
  new_orders_.push_back({Ask::kLand, up, reason});
  return VehiclesText(up) + (up.size() == 1 ? " lands" : " land");
}

std::string Fleet::StopMotors(int agent, const std::string& reason) {
  const auto found = vehicles_.find(agent);
  if (found == vehicles_.end()) throw std::invalid_argument(fmt::format("kill: agent {} has no vehicle", agent));
  if (!found->second.has_process)
    throw std::invalid_argument(
        fmt::format("kill: the process of vehicle {} has ended: nobody is there who could stop its motors", agent));
  if (found->second.state.phase == FlightPhase::kAbsent)
    throw std::invalid_argument(fmt::format("kill: nothing is heard of vehicle {}", agent));
  const std::vector<std::uint32_t> ids{static_cast<std::uint32_t>(agent)};
  new_orders_.push_back({Ask::kStopMotors, ids, reason});
  return fmt::format("the motors of vehicle {} are to stop", agent);
}

std::vector<Fleet::Order> Fleet::Orders(Time now) {
  std::vector<Order> orders = std::exchange(new_orders_, {});
  if (now >= repeat_at_) {
    for (Order& order : repeated_) {
      std::erase_if(order.agents, [&](std::uint32_t id) {
        const FlightPhase phase = vehicles_.at(static_cast<int>(id)).state.phase;
        return order.ask == Ask::kLand ? phase >= FlightPhase::kLanding || phase <= FlightPhase::kFound
                                       : phase >= FlightPhase::kLanded;
      });
      if (!order.agents.empty()) orders.push_back(order);
    }
    std::erase_if(repeated_, [](const Order& order) { return order.agents.empty(); });
    repeat_at_ = now + kRepeatEvery;
  }
  for (const Order& order : orders)
    if (order.ask != Ask::kStart && std::ranges::find(repeated_, order) == repeated_.end()) repeated_.push_back(order);
  return orders;
}

bool Fleet::AreFound() const {
  return std::ranges::all_of(vehicles_,
                             [](const auto& entry) { return entry.second.state.phase == FlightPhase::kFound; });
}

bool Fleet::AreReady() const {
  return std::ranges::all_of(vehicles_, [](const auto& entry) { return IsReady(entry.second.state.phase); });
}

bool Fleet::AreDown() const { return Flying().empty(); }

std::string Fleet::Phases() const {
  std::string text;
  for (const auto& [id, vehicle] : vehicles_)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", id, kFlightPhases.Name(vehicle.state.phase));
  return text;
}

/// The vehicles in these phases, for people: "vehicles 1, 2 are found, vehicle 3 is armed".
std::string Fleet::InPhases(bool (*these)(FlightPhase)) const {
  std::map<FlightPhase, std::vector<std::uint32_t>> agents;
  for (const auto& [id, vehicle] : vehicles_)
    if (these(vehicle.state.phase)) agents[vehicle.state.phase].push_back(static_cast<std::uint32_t>(id));
  std::string text;
  for (const auto& [phase, ids] : agents)
    text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ", VehiclesText(ids), ids.size() == 1 ? "is" : "are",
                        kFlightPhases.Name(phase));
  return text;
}

std::string Fleet::Awaited() const {
  const std::string text = InPhases([](FlightPhase phase) { return !IsReady(phase); });
  return text.empty() ? "all vehicles are ready, and the first tick is to come" : text;
}

std::string Fleet::WhyNotToBegin() const {
  return InPhases([](FlightPhase phase) { return phase == FlightPhase::kLanded || phase == FlightPhase::kLost; });
}

}  // namespace mascot
