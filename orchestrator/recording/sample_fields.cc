#include "orchestrator/recording/sample_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bus/cdr.h"
#include "bus/wire.h"
#include "orchestrator/ros/ros_scene.h"

namespace mascot {
namespace {

using SampleBytes = std::span<const std::uint8_t>;

/// Names and values of the fields of one sample, in the order of its definition.
class FieldList {
 public:
  template <class Plain>
  void Add(const std::string& name, const Plain& value) {
    fields_.emplace_back(name, fmt::format("{}", value));
  }
  void Add(const std::string& name, const builtin_interfaces::msg::Time& time) {
    Add(name + ".sec", time.sec());
    Add(name + ".nanosec", time.nanosec());
  }
  template <class Vector>
  void AddXyz(const std::string& name, const Vector& vector) {
    Add(name + ".x", vector.x());
    Add(name + ".y", vector.y());
    Add(name + ".z", vector.z());
  }
  template <class Numbers>
  void AddAll(const std::string& name, const Numbers& numbers) {
    for (std::size_t k = 0; k < numbers.size(); ++k) Add(fmt::format("{}[{}]", name, k), numbers[k]);
  }
  template <class Sample>
  void AddHead(const Sample& sample) {
    Add("stamp", sample.stamp());
    Add("tick", sample.tick());
    Add("agent", sample.agent());
  }

  const std::vector<std::pair<std::string, std::string>>& fields() const { return fields_; }

 private:
  std::vector<std::pair<std::string, std::string>> fields_;
};

void AddFields(const mascot_msgs::msg::AgentState& state, FieldList& list) {
  list.AddHead(state);
  list.Add("events", state.events());
  list.AddXyz("pose.position", state.pose().position());
  list.AddXyz("pose.orientation", state.pose().orientation());
  list.Add("pose.orientation.w", state.pose().orientation().w());
  list.AddXyz("twist.linear", state.twist().linear());
  list.AddXyz("twist.angular", state.twist().angular());
  list.AddXyz("acceleration", state.acceleration());
}

void AddFields(const mascot_msgs::msg::AgentCommand& command, FieldList& list) {
  list.AddHead(command);
  list.Add("flags", command.flags());
  list.AddAll("actuator", command.actuator());
  list.AddXyz("acceleration_wanted", command.acceleration_wanted());
  list.AddXyz("acceleration_limited", command.acceleration_limited());
}

void AddFields(const mascot_msgs::msg::AgentMessage& message, FieldList& list) {
  list.AddHead(message);
  list.Add("data.size()", message.data().size());
  list.AddAll("data", message.data());
}

void AddFields(const mascot_msgs::msg::AgentAction& action, FieldList& list) {
  list.AddHead(action);
  list.Add("data.size()", action.data().size());
  list.AddAll("data", action.data());
}

void AddFields(const rosgraph_msgs::msg::Clock& clock, FieldList& list) { list.Add("clock", clock.clock()); }

void AddFields(const mascot_msgs::msg::Event& event, FieldList& list) {
  list.Add("stamp", event.stamp());
  list.Add("tick", event.tick());
  list.Add("number", event.number());
  list.Add("toml", event.toml());
}

void AddFields(const nav_msgs::msg::Odometry& odometry, FieldList& list) {
  list.Add("header.stamp", odometry.header().stamp());
  list.AddXyz("pose.pose.position", odometry.pose().pose().position());
  list.AddXyz("pose.pose.orientation", odometry.pose().pose().orientation());
  list.Add("pose.pose.orientation.w", odometry.pose().pose().orientation().w());
  list.AddXyz("twist.twist.linear", odometry.twist().twist().linear());
  list.AddXyz("twist.twist.angular", odometry.twist().twist().angular());
}

FieldList FieldsOfOdometry(SampleBytes bytes) {
  nav_msgs::msg::Odometry odometry;
  if (!Decode<nav_msgs::msg::OdometryPubSubType>(bytes, odometry)) throw std::runtime_error("no odometry");
  FieldList list;
  AddFields(odometry, list);
  return list;
}

template <class Sample>
FieldList FieldsAs(SampleBytes bytes) {
  Sample sample;
  Deserialize(bytes, sample);
  FieldList list;
  AddFields(sample, list);
  return list;
}

/// Throws std::runtime_error for bytes that are no such sample.
FieldList FieldsOf(TopicKind kind, SampleBytes bytes) {
  switch (kind) {
    case TopicKind::kState:
      return FieldsAs<mascot_msgs::msg::AgentState>(bytes);
    case TopicKind::kCommand:
      return FieldsAs<mascot_msgs::msg::AgentCommand>(bytes);
    case TopicKind::kMessage:
      return FieldsAs<mascot_msgs::msg::AgentMessage>(bytes);
    case TopicKind::kAction:
      return FieldsAs<mascot_msgs::msg::AgentAction>(bytes);
    case TopicKind::kEvent:
      return FieldsAs<mascot_msgs::msg::Event>(bytes);
    case TopicKind::kOdom:
      return FieldsOfOdometry(bytes);
    default:
      return FieldsAs<rosgraph_msgs::msg::Clock>(bytes);
  }
}

std::optional<SampleDifference> FirstFieldThatDiffers(TopicKind kind, SampleBytes first, SampleBytes second) try {
  const FieldList a = FieldsOf(kind, first), b = FieldsOf(kind, second);
  const auto [in_a, in_b] = std::ranges::mismatch(a.fields(), b.fields());
  if (in_a == a.fields().end() || in_b == b.fields().end()) return std::nullopt;
  return SampleDifference{in_a->first, in_a->second, in_b->second};
} catch (const std::runtime_error&) {
  return std::nullopt;
}

}  // namespace

std::optional<SampleDifference> FirstDifference(TopicKind kind, SampleBytes first, SampleBytes second) {
  if (std::ranges::equal(first, second)) return std::nullopt;
  if (auto field = FirstFieldThatDiffers(kind, first, second)) return field;
  if (first.size() != second.size())
    return SampleDifference{"size", fmt::format("{} bytes", first.size()), fmt::format("{} bytes", second.size())};
  const auto [a, b] = std::ranges::mismatch(first, second);
  return SampleDifference{fmt::format("byte {}", a - first.begin()), fmt::format("{:#04x}", *a),
                          fmt::format("{:#04x}", *b)};
}

}  // namespace mascot
