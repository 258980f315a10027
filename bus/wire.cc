#include "bus/wire.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/fnv.h"
#include "idl/schemas.h"

namespace mascot {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

geometry_msgs::msg::Vector3 ToVector3(const Eigen::Vector3d& v) {
  geometry_msgs::msg::Vector3 wire;
  wire.x(v.x());
  wire.y(v.y());
  wire.z(v.z());
  return wire;
}

Eigen::Vector3d FromVector3(const geometry_msgs::msg::Vector3& wire) { return {wire.x(), wire.y(), wire.z()}; }

builtin_interfaces::msg::Time ToTime(std::int64_t tick, int rate_hz) {
  const std::uint64_t ns = StampNs(tick, rate_hz);
  builtin_interfaces::msg::Time stamp;
  stamp.sec(static_cast<std::int32_t>(ns / 1'000'000'000));
  stamp.nanosec(static_cast<std::uint32_t>(ns % 1'000'000'000));
  return stamp;
}

template <class PubSub>
void SerializeAs(typename PubSub::type& sample, std::vector<std::uint8_t>& bytes) {
  thread_local ZeroPadded<PubSub> type;
  thread_local SerializedPayload_t payload(type.m_typeSize);
  payload.length = 0;
  payload.reserve(type.getSerializedSizeProvider(&sample)());
  if (!type.serialize(&sample, &payload)) throw std::logic_error("a sample did not fit its own type");
  bytes.assign(payload.data, payload.data + payload.length);
}

/// How many bytes a sample of a type may have, as the generated type says it.
enum class Size { kFixed, kBounded, kAny };

template <class PubSub>
void DeserializeAs(std::span<const std::uint8_t> bytes, typename PubSub::type& sample, Size size = Size::kFixed) {
  thread_local const PubSub type;
  const bool fits = size == Size::kAny || bytes.size() == type.m_typeSize ||
                    (size == Size::kBounded && bytes.size() < type.m_typeSize);
  if (!fits || !Decode<PubSub>(bytes, sample))
    throw std::runtime_error("a sample of " + std::to_string(bytes.size()) + " bytes is no " + type.getName());
}

}  // namespace

std::uint64_t DigestOf(const mascot_msgs::msg::Experiment& experiment) {
  return std::max<std::uint64_t>(Fnv1a(experiment.toml()), 1);
}

std::string WireTypeName(TopicKind kind) {
  const std::string_view name = SchemaOf(kind).name;  // "package/msg/Type"
  const std::size_t first = name.find('/'), last = name.rfind('/');
  return fmt::format("{}::msg::dds_::{}_", name.substr(0, first), name.substr(last + 1));
}

Life CheckedLife(const mascot_msgs::msg::Status& status, std::int64_t last_tick) {
  const unsigned state = status.state();
  if (state <= static_cast<unsigned>(Life::kEnded) && std::cmp_less_equal(status.tick(), last_tick + 1))
    return static_cast<Life>(state);
  throw std::runtime_error("/status: expected a state of 0 to 6 and a tick of 0 to " + std::to_string(last_tick + 1) +
                           " from " + status.process().to_string() + ", got state " + std::to_string(state) +
                           " and tick " + std::to_string(status.tick()));
}

std::int64_t CheckedTick(const Topic& topic, std::uint32_t agent, std::uint64_t tick, std::int64_t last_tick) {
  if (std::cmp_equal(agent, topic.agent) && std::cmp_less_equal(tick, last_tick))
    return static_cast<std::int64_t>(tick);
  throw std::runtime_error(topic.Name() + ": expected a tick of 0 to " + std::to_string(last_tick) + " of agent " +
                           std::to_string(topic.agent) + ", got tick " + std::to_string(tick) + " of agent " +
                           std::to_string(agent));
}

std::uint64_t StampNs(std::int64_t tick, int rate_hz) {
  const auto rate = static_cast<std::uint64_t>(rate_hz);
  const auto k = static_cast<std::uint64_t>(tick);
  return (k / rate) * 1'000'000'000 + ((k % rate) * 1'000'000'000 + rate / 2) / rate;
}

void ToWire(std::int64_t tick, int rate_hz, int agent, int events, const Motion& motion,
            mascot_msgs::msg::AgentState& sample) {
  sample.stamp(ToTime(tick, rate_hz));
  sample.tick(static_cast<std::uint64_t>(tick));
  sample.agent(static_cast<std::uint32_t>(agent));
  sample.events(static_cast<std::uint32_t>(events));
  auto& position = sample.pose().position();
  position.x(motion.p_WB.x());
  position.y(motion.p_WB.y());
  position.z(motion.p_WB.z());
  auto& orientation = sample.pose().orientation();
  orientation.x(motion.q_WB.x());
  orientation.y(motion.q_WB.y());
  orientation.z(motion.q_WB.z());
  orientation.w(motion.q_WB.w());
  sample.twist().linear(ToVector3(motion.v_WB));
  sample.twist().angular(ToVector3(motion.w_WB_B));
  sample.acceleration(ToVector3(motion.a_WB));
}

void ToWire(std::int64_t tick, int rate_hz, int agent, const Command& command, mascot_msgs::msg::AgentCommand& sample) {
  sample.stamp(ToTime(tick, rate_hz));
  sample.tick(static_cast<std::uint64_t>(tick));
  sample.agent(static_cast<std::uint32_t>(agent));
  sample.flags(command.flags);
  sample.actuator(command.actuator);
  sample.acceleration_wanted(ToVector3(command.a_law_W));
  sample.acceleration_limited(ToVector3(command.a_limited_W));
}

void ToWire(std::int64_t tick, int rate_hz, int agent, std::span<const double> message,
            mascot_msgs::msg::AgentMessage& sample) {
  sample.stamp(ToTime(tick, rate_hz));
  sample.tick(static_cast<std::uint64_t>(tick));
  sample.agent(static_cast<std::uint32_t>(agent));
  sample.data().assign(message.begin(), message.end());
}

void ToWire(std::int64_t tick, int rate_hz, rosgraph_msgs::msg::Clock& sample) { sample.clock(ToTime(tick, rate_hz)); }

void ToWire(std::int64_t tick, int rate_hz, int number, const std::string& toml, mascot_msgs::msg::Event& sample) {
  sample.stamp(ToTime(tick, rate_hz));
  sample.tick(static_cast<std::uint64_t>(tick));
  sample.number(static_cast<std::uint32_t>(number));
  sample.toml(toml);
}

namespace {

/// Values of Incident::kind.
enum class IncidentKind : std::uint8_t { kContact = 0, kLate };

void CheckIncident(const mascot_msgs::msg::Incident& incident, int agents, std::size_t obstacles,
                   std::int64_t last_tick) {
  const bool is_late = incident.kind() == static_cast<std::uint8_t>(IncidentKind::kLate);
  const bool is_known = is_late || incident.kind() == static_cast<std::uint8_t>(IncidentKind::kContact);
  const std::int64_t other = incident.other();
  if (is_known && incident.agent() >= 1 && std::cmp_less_equal(incident.agent(), agents) && other <= agents &&
      std::cmp_less_equal(-other, obstacles) && incident.from_tick() <= incident.to_tick() &&
      std::cmp_less_equal(incident.to_tick(), last_tick) && std::isfinite(incident.speed()))
    return;
  throw std::runtime_error("/status: expected incidents of agents 1 to " + std::to_string(agents) + " at ticks 0 to " +
                           std::to_string(last_tick) + ", got kind " + std::to_string(incident.kind()) + ", agent " +
                           std::to_string(incident.agent()) + ", other " + std::to_string(other) + ", ticks " +
                           std::to_string(incident.from_tick()) + " to " + std::to_string(incident.to_tick()));
}

}  // namespace

void ToWire(const Pacing& pacing, const Contacts& contacts, mascot_msgs::msg::Status& status) {
  status.misses(pacing.misses);
  status.tick_lateness_s(pacing.tick_lateness_s);
  status.command_age_s(pacing.command_age_s);
  status.agent_contacts(static_cast<std::uint64_t>(contacts.agents));
  status.ground_contacts(static_cast<std::uint64_t>(contacts.ground));
  status.obstacle_contacts(static_cast<std::uint64_t>(contacts.obstacles));
  status.incidents().clear();
  const auto add = [&status](IncidentKind kind, int agent, const Episode& ticks) -> mascot_msgs::msg::Incident& {
    mascot_msgs::msg::Incident& incident = status.incidents().emplace_back();
    incident.kind(static_cast<std::uint8_t>(kind));
    incident.agent(static_cast<std::uint32_t>(agent));
    incident.from_tick(static_cast<std::uint64_t>(ticks.from));
    incident.to_tick(static_cast<std::uint64_t>(ticks.to));
    incident.count(static_cast<std::uint64_t>(ticks.count));
    return incident;
  };
  for (const Contact& contact : contacts.first) {
    auto& incident = add(IncidentKind::kContact, contact.agent, {.from = contact.tick, .to = contact.tick, .count = 1});
    incident.other(contact.other);
    incident.speed(contact.speed_m_per_s);
  }
  for (const LateCommands& late : pacing.late) add(IncidentKind::kLate, late.agent, late.ticks);
}

void FromWire(const mascot_msgs::msg::Status& status, int agents, std::size_t obstacles, std::int64_t last_tick,
              Pacing& pacing, Contacts& contacts) {
  pacing = {.misses = status.misses(),
            .late = {},
            .tick_lateness_s = status.tick_lateness_s(),
            .command_age_s = status.command_age_s()};
  contacts = {.agents = static_cast<std::int64_t>(status.agent_contacts()),
              .ground = static_cast<std::int64_t>(status.ground_contacts()),
              .obstacles = static_cast<std::int64_t>(status.obstacle_contacts()),
              .first = {}};
  for (const mascot_msgs::msg::Incident& incident : status.incidents()) {
    CheckIncident(incident, agents, obstacles, last_tick);
    const int agent = static_cast<int>(incident.agent());
    const Episode ticks{.from = static_cast<std::int64_t>(incident.from_tick()),
                        .to = static_cast<std::int64_t>(incident.to_tick()),
                        .count = static_cast<std::int64_t>(incident.count())};
    if (incident.kind() == static_cast<std::uint8_t>(IncidentKind::kContact))
      contacts.first.push_back(
          {.tick = ticks.from, .agent = agent, .other = incident.other(), .speed_m_per_s = incident.speed()});
    else
      pacing.late.push_back({.agent = agent, .ticks = ticks});
  }
}

Motion FromWire(const mascot_msgs::msg::AgentState& sample) {
  const auto& position = sample.pose().position();
  const auto& orientation = sample.pose().orientation();
  Motion motion;
  motion.p_WB = {position.x(), position.y(), position.z()};
  motion.q_WB = Eigen::Quaterniond(orientation.w(), orientation.x(), orientation.y(), orientation.z());
  motion.v_WB = FromVector3(sample.twist().linear());
  motion.w_WB_B = FromVector3(sample.twist().angular());
  motion.a_WB = FromVector3(sample.acceleration());
  return motion;
}

Command FromWire(const mascot_msgs::msg::AgentCommand& sample) {
  Command command;
  command.actuator = sample.actuator();
  command.a_law_W = FromVector3(sample.acceleration_wanted());
  command.a_limited_W = FromVector3(sample.acceleration_limited());
  command.flags = sample.flags();
  return command;
}

Event FromWire(const mascot_msgs::msg::Event& sample, int agents) {
  return EventFrom(static_cast<std::int64_t>(sample.tick()), sample.toml(), agents,
                   "event " + std::to_string(sample.number()));
}

Event FromWire(const mascot_msgs::msg::Event& sample, int agents, int number, std::int64_t last_tick) {
  if (!std::cmp_equal(sample.number(), number) || std::cmp_greater(sample.tick(), last_tick))
    throw std::runtime_error("/event: expected event " + std::to_string(number) + " with a tick of 0 to " +
                             std::to_string(last_tick) + ", got event " + std::to_string(sample.number()) +
                             " with tick " + std::to_string(sample.tick()));
  return FromWire(sample, agents);
}

void Serialize(mascot_msgs::msg::AgentState& sample, std::vector<std::uint8_t>& bytes) {
  SerializeAs<StateType>(sample, bytes);
}
void Serialize(mascot_msgs::msg::AgentCommand& sample, std::vector<std::uint8_t>& bytes) {
  SerializeAs<CommandType>(sample, bytes);
}
void Serialize(mascot_msgs::msg::AgentMessage& sample, std::vector<std::uint8_t>& bytes) {
  SerializeAs<MessageType>(sample, bytes);
}
void Serialize(mascot_msgs::msg::AgentAction& sample, std::vector<std::uint8_t>& bytes) {
  SerializeAs<ActionType>(sample, bytes);
}
void Serialize(rosgraph_msgs::msg::Clock& sample, std::vector<std::uint8_t>& bytes) {
  SerializeAs<ClockType>(sample, bytes);
}
void Serialize(mascot_msgs::msg::Event& sample, std::vector<std::uint8_t>& bytes) {
  SerializeAs<EventType>(sample, bytes);
  bytes.resize(PaddedSize(static_cast<std::uint32_t>(bytes.size())));
}
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentState& sample) {
  DeserializeAs<StateType>(bytes, sample);
}
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentCommand& sample) {
  DeserializeAs<CommandType>(bytes, sample);
}
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentMessage& sample) {
  DeserializeAs<MessageType>(bytes, sample, Size::kBounded);
}
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentAction& sample) {
  DeserializeAs<ActionType>(bytes, sample, Size::kBounded);
}
void Deserialize(std::span<const std::uint8_t> bytes, rosgraph_msgs::msg::Clock& sample) {
  DeserializeAs<ClockType>(bytes, sample);
}
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::Event& sample) {
  DeserializeAs<EventType>(bytes, sample, Size::kAny);
}

}  // namespace mascot
