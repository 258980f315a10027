#include "experiment/vehicles.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "experiment/agent_ids.h"
#include "experiment/experiment.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxTables = 1000;
constexpr std::string_view kFrameOrigins[] = {"start", "shared"};
constexpr std::string_view kId = "{i}";
constexpr Range kCorner_m = {-1e6, 1e6};

/// What a kind can do, and what it has by default.
struct KindTraits {
  VehicleKind kind;
  std::string_view name_space;
  bool may_have_no_name;                ///< an empty namespace
  std::vector<SetpointKind> setpoints;  ///< the first is the default
  int system_id_ahead;                  ///< of the agent's number
  bool arms_itself = false;
  double farthest_m = 1e6;
};
const KindTraits& KindTraitsOf(VehicleKind kind) {
  static const KindTraits kKinds[] = {
      {VehicleKind::kPx4,
       "px4_{i}",
       true,
       {SetpointKind::kReference, SetpointKind::kAcceleration, SetpointKind::kVelocity},
       1},  // MAV_SYS_ID of the simulation's instance i is i + 1
      {VehicleKind::kCrazyswarm,
       "cf{i}",
       false,
       {SetpointKind::kReference, SetpointKind::kVelocity},
       0,
       true,
       32.767},  // set-points travel as int16 of mm
      {VehicleKind::kArdupilot, "ap", false, {SetpointKind::kVelocity}, 0},
  };
  return *std::ranges::find(kKinds, kind, &KindTraits::kind);
}

/// `text` with the agent's number for each {i}.
std::string WithId(std::string text, int id) {
  for (auto place = text.find(kId); place != text.npos; place = text.find(kId))
    text.replace(place, kId.size(), std::to_string(id));
  return text;
}

/// Whether it is a name of ROS 2 topics, or several with '/' between; or nothing.
bool IsNamespace(std::string_view text) {
  if (text.empty()) return true;
  bool begins = true;
  for (const char c : text) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_letter && (begins || (!is_digit && c != '/'))) return false;
    begins = c == '/';
  }
  return !begins && text.size() <= 100;
}

std::vector<int> ReadAgentsOf(Section& section, int count) {
  if (section.Kind("agents") == "list") return ReadAgentIds(section, "agents", count);
  std::vector<int> ids;
  for (const AgentRange& range : ReadAgentRanges(section, "agents", count > 0 ? count : static_cast<int>(kMaxAgents)))
    for (int id = range.first; id <= range.last; ++id) ids.push_back(id);
  return ids;
}

void ReadFence(Section& section, VehicleConfig& vehicle) {
  const std::vector<Eigen::Vector3d> corners = section.Points("fence");
  if (section.Wrong("fence") || corners.empty()) return;
  if (corners.size() != 2 || (corners[0].array() >= corners[1].array()).any())
    section.Fail("fence", "expected [[x, y, z], [x, y, z]], the lowest corner and the highest, got " +
                              (corners.size() == 2 ? "corners that are not below and above"
                                                   : std::to_string(corners.size()) + " points"));
  else
    vehicle.fence_W = Eigen::AlignedBox3d(corners[0], corners[1]);
}

void ReadSetpoint(Section& section, VehicleConfig& vehicle) {
  const auto& can = KindTraitsOf(vehicle.kind).setpoints;
  vehicle.setpoint = kSetpointKinds.Value(
      section.OneOf("setpoint", kSetpointKinds.names(), std::string(kSetpointKinds.Name(can.front()))));
  if (section.Wrong("setpoint") || std::ranges::find(can, vehicle.setpoint) != can.end()) return;
  std::string list;
  for (const SetpointKind each : can)
    list += fmt::format("{}\"{}\"", list.empty() ? "" : " or ", kSetpointKinds.Name(each));
  section.Fail("setpoint", fmt::format("expected {} with kind = \"{}\", got '{}'", list,
                                       kVehicleKinds.Name(vehicle.kind), kSetpointKinds.Name(vehicle.setpoint)));
}

/// Where the origins of these agents' vehicles are, in W.
std::map<int, Eigen::Vector3d> ReadOrigins(Section& section, const std::vector<int>& ids,
                                           const Experiment& experiment) {
  std::map<int, Eigen::Vector3d> origins;
  if (section.Kind("origin") == "list") {
    const Eigen::Vector3d origin_W = section.Vector3("origin", kCorner_m.min, kCorner_m.max);
    for (const int id : ids) origins[id] = origin_W;
    return origins;
  }
  const bool is_shared = section.OneOf("origin", kFrameOrigins) == "shared";
  for (const int id : ids) {
    origins[id].setZero();
    // It was switched on where its agent starts, on the ground.
    if (!is_shared && !experiment.agents.empty()) origins[id].head<2>() = experiment.agent(id).p_W.head<2>();
  }
  return origins;
}

std::string ReadNamespace(Section& section, const std::vector<int>& ids, VehicleKind kind) {
  const std::string text = section.Text("namespace", std::string(KindTraitsOf(kind).name_space));
  if (section.Wrong("namespace")) return text;
  if (!IsNamespace(WithId(text, 1)) || (text.empty() && !KindTraitsOf(kind).may_have_no_name))
    section.Fail("namespace", "expected a namespace of ROS 2 topics, such as \"px4_{i}\", got '" + text + "'");
  else if (ids.size() > 1 && text.find(kId) == text.npos)
    section.Fail("namespace",
                 "expected {i}, the agent's number, in the namespace of several vehicles, got '" + text + "'");
  return text;
}

/// Notes why an agent cannot have a vehicle.
void CheckAgentOf(Section& section, const AgentConfig& agent) {
  if (section.Wrong("agents")) return;
  if (agent.vehicle)
    section.Fail("agents", EachOnce("agent", std::to_string(agent.id)));
  else if (agent.traits().driven_by != Wanted::kAcceleration)
    section.Fail("agents", fmt::format("expected agents of a model that is driven by acceleration, got agent {}, a {}",
                                       agent.id, agent.model));
}

/// Notes that an agent starts where its vehicle cannot be sent.
void CheckStart(Section& section, const AgentConfig& agent, const VehicleConfig& vehicle) {
  const Eigen::AngleAxisd turn(-vehicle.yaw_rad, Eigen::Vector3d::UnitZ());
  const double farthest_m = (turn * (agent.p_W - vehicle.origin_W)).cwiseAbs().maxCoeff();
  if (farthest_m > vehicle.farthest_m && !section.Wrong("agents"))
    section.Fail("agents",
                 fmt::format("expected agents that start within {:g} m of the origin of their vehicles' frames, "
                             "along its axes, got agent {} at {:g} m",
                             vehicle.farthest_m, agent.id, farthest_m));
}

/// The agent of each vehicle, by its domain and namespace.
using FlownBy = std::map<std::pair<int, std::string>, int>;

void ReadVehicle(Section& section, FlownBy& flown_by, Experiment& experiment) {
  VehicleConfig vehicle;
  const std::vector<int> ids = ReadAgentsOf(section, experiment.size());
  vehicle.kind = kVehicleKinds.Value(section.OneOf("kind"));
  vehicle.arms_itself = KindTraitsOf(vehicle.kind).arms_itself;
  vehicle.farthest_m = KindTraitsOf(vehicle.kind).farthest_m;
  const std::string name_space = ReadNamespace(section, ids, vehicle.kind);
  const int ahead = KindTraitsOf(vehicle.kind).system_id_ahead;
  const bool has_system_id = section.Has("system_id");
  const int system_id = has_system_id ? static_cast<int>(section.Integer("system_id")) : 0;
  vehicle.domain = static_cast<int>(section.Integer("domain"));
  vehicle.address = section.Text("address");
  if (!section.Wrong("address") && !vehicle.address.empty() && !IsAddress(vehicle.address))
    section.Fail("address", "expected an IPv4 address, got '" + vehicle.address + "'");
  ReadSetpoint(section, vehicle);
  const auto origins = ReadOrigins(section, ids, experiment);
  vehicle.yaw_rad = section.Number("yaw_rad");
  vehicle.takeoff_m = section.Number("takeoff_m");
  ReadFence(section, vehicle);
  vehicle.max_error_m = section.Number("max_error_m");
  vehicle.on_loss = kOnVehicleLoss.Value(section.OneOf("on_loss"));
  section.Done();
  if (experiment.agents.empty()) return;
  int number = 0;
  for (const int id : ids) {
    AgentConfig& agent = experiment.agents[static_cast<std::size_t>(id - 1)];
    CheckAgentOf(section, agent);
    vehicle.name_space = WithId(name_space, id);
    vehicle.system_id = has_system_id ? system_id + number : id + ahead;
    vehicle.origin_W = origins.at(id);
    if (vehicle.system_id > 255 && !section.Wrong("system_id"))
      section.Fail("system_id", fmt::format("expected at most 255, got {} for agent {}", vehicle.system_id, id));
    CheckStart(section, agent, vehicle);
    const auto [other, is_new] = flown_by.try_emplace({vehicle.domain, vehicle.name_space}, id);
    if (!is_new && other->second != id && !section.Wrong("namespace"))
      section.Fail("namespace",
                   fmt::format("expected a namespace that no other vehicle of domain {} has, got '{}' of agents "
                               "{} and {}",
                               vehicle.domain, vehicle.name_space, other->second, id));
    agent.vehicle = vehicle;
    ++number;
  }
}

}  // namespace

std::vector<int> AgentsWithVehicles(const Experiment& experiment) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents)
    if (agent.vehicle) ids.push_back(agent.id);
  return ids;
}

std::span<const Key> VehicleKeys() {
  static const Key keys[] = {
      key::Text("agents", "the agents whose bodies are vehicles: \"1-4\", \"1-3,8\" or [1, 2]")
          .Or(ValueKind::kNumbers)
          .With(&Key::range, Range{1, static_cast<double>(kMaxAgents)})
          .Required(),
      key::OneOf("kind", kVehicleKinds.names(), "px4: PX4 1.14 to 1.18; crazyswarm: Crazyswarm2; ardupilot: ArduPilot")
          .Required(),
      key::Text("namespace", "before the names of a vehicle's topics; {i} is the agent's number")
          .Otherwise("`\"px4_{i}\"`, `\"cf{i}\"`, `\"ap\"`"),
      key::Integer("system_id", 1, 255, "MAV_SYS_ID of the first vehicle; the others count on")
          .Otherwise("the agent's number, and one more with px4"),
      key::Integer("domain", 0, 232, "DDS domain of the vehicles, never that of the run").Default("0"),
      key::Text(
          "address",
          "IPv4 address of the interface on which the vehicles are, 127.0.0.1 if they are programs on this machine; "
          "empty: all interfaces")
          .Default("\"\""),
      key::OneOf(
          "setpoint", kSetpointKinds.names(),
          "what a vehicle is sent. reference: position, velocity and acceleration of an ideal body under the law")
          .Otherwise("reference; with ardupilot velocity"),
      key::OneOf("origin", kFrameOrigins,
                 "where the origin of a vehicle's local frame is, in W. start: on the ground at its agent's start; "
                 "shared: the world's")
          .Or(ValueKind::kVector3)
          .Default("\"start\""),
      key::Number("yaw_rad", {-10, 10}, "yaw of a vehicle's local frame in W").Default("0.0"),
      key::Number("takeoff_m", Above(0, 100), "how high a vehicle climbs before it flies to its agent's start")
          .Default("1.0"),
      key::Points("fence", kCorner_m, "lowest and highest corner of a box in W; a vehicle that leaves it lands"),
      key::Number("max_error_m", Above(0, 1e6),
                  "a vehicle that is farther from its reference lands, also if it is sent no positions")
          .Default("1.0"),
      key::OneOf("on_loss", kOnVehicleLoss.names(),
                 "when another vehicle is lost. land: this one lands; hold: it flies on")
          .Default("\"land\""),
  };
  return keys;
}

void ReadVehicles(Section& document, Section& run, Experiment& experiment) {
  std::vector<Section> sections = FewTables(document, "vehicles", kMaxTables);
  FlownBy flown_by;
  for (Section& section : sections) ReadVehicle(section, flown_by, experiment);
  if (sections.empty()) return;
  if (experiment.run.mode != Mode::kRealtime && !run.Wrong("mode"))
    run.Fail("mode", "expected \"realtime\" with [[vehicles]], got \"lockstep\"");
  else if (experiment.run.speed != 1 && !run.Wrong("speed"))
    run.Fail("speed", "expected 1.0 with [[vehicles]], got " + ShortestFloat(experiment.run.speed));
  for (Section& section : sections)
    if (const auto domain = section.Integer("domain"); domain == experiment.network.domain && !section.Wrong("domain"))
      section.Fail("domain", fmt::format("expected another domain than the run's (network.domain), got {}", domain));
}

}  // namespace mascot
