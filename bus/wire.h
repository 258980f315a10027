#pragma once

#include <mascotPubSubTypes.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/contacts.h"
#include "base/motion.h"
#include "base/pacing.h"
#include "bus/cdr.h"
#include "idl/topics.h"

namespace mascot {

using StateType = mascot_msgs::msg::AgentStatePubSubType;
using BundleType = mascot_msgs::msg::AgentBundlePubSubType;
using CommandType = mascot_msgs::msg::AgentCommandPubSubType;
using MessageType = mascot_msgs::msg::AgentMessagePubSubType;
using ClockType = rosgraph_msgs::msg::ClockPubSubType;
using EventType = mascot_msgs::msg::EventPubSubType;
using StatusType = mascot_msgs::msg::StatusPubSubType;
using RequestType = mascot_msgs::msg::RequestPubSubType;
using ExperimentType = mascot_msgs::msg::ExperimentPubSubType;

template <>
struct SequenceOf<MessageType> {
  static constexpr std::size_t kAt = 24, kElement = sizeof(double);
};
template <>
struct SequenceOf<StatusType> {
  static constexpr std::size_t kAt = 4, kElement = 44;
};
template <>
struct SequenceOf<BundleType> {
  static constexpr std::size_t kAt = 4, kElement = 152;
};
template <>
struct SequenceOf<ExperimentType> {
  static constexpr std::size_t kAt = 4, kElement = 24;
};

/// Values of Status::state: where a process is in its lifecycle.
enum class Life : std::uint8_t { kWaiting = 0, kMatching, kReady, kRunning, kDone, kFailed, kEnded };
/// True for the final states: done, failed, ended.
constexpr bool IsLast(Life life) { return life >= Life::kDone; }
/// The state that a status tells. Throws std::runtime_error if there is no such state, or if the tick is more than one
/// beyond the last of the run.
Life CheckedLife(const mascot_msgs::msg::Status& status, std::int64_t last_tick);
/// Values of Request::kind.
enum class Ask : std::uint8_t { kReport = 0, kStop, kEnd, kPause, kResume, kStep, kPace, kEvent };
/// Values of Status::request_tick for requests that hold for no tick: the run was over; an event came too late.
inline constexpr std::int64_t kOver = -1, kTooLate = -2;

/// A number that two processes compare to know that they fly the same experiment: the FNV-1a hash of its text. Never 0.
std::uint64_t DigestOf(const mascot_msgs::msg::Experiment& experiment);

/// DDS type name of the samples on topics of this kind: "mascot_msgs::msg::dds_::AgentState_".
std::string WireTypeName(TopicKind kind);

/// Simulated time of `tick` in nanoseconds: rounded from tick / rate, never accumulated.
std::uint64_t StampNs(std::int64_t tick, int rate_hz);

/// The tick of a sample that says it is of this agent and tick. Throws std::runtime_error unless `topic` is that
/// agent's and the tick is one of the run, whose last is `last_tick`.
std::int64_t CheckedTick(const Topic& topic, std::uint32_t agent, std::uint64_t tick, std::int64_t last_tick);

/// The tick of event `number`. Throws std::runtime_error if the sample is of another event, or its tick is none of the
/// run, whose last is `last_tick`.
std::int64_t CheckedEvent(const mascot_msgs::msg::Event& event, int number, std::int64_t last_tick);

// The only conversions between our types and the wire types (whose quaternions are x, y, z, w).
/// `events`: how many have taken effect up to this tick.
void ToWire(std::int64_t tick, int rate_hz, int agent, int events, const Motion& motion,
            mascot_msgs::msg::AgentState& sample);
void ToWire(std::int64_t tick, int rate_hz, int agent, const Command& command, mascot_msgs::msg::AgentCommand& sample);
void ToWire(std::int64_t tick, int rate_hz, int agent, std::span<const double> message,
            mascot_msgs::msg::AgentMessage& sample);
void ToWire(std::int64_t tick, int rate_hz, rosgraph_msgs::msg::Clock& sample);
/// `number`, `toml`: of the event.
void ToWire(std::int64_t tick, int rate_hz, int number, const std::string& toml, mascot_msgs::msg::Event& sample);
/// Puts what the physics server reports of its timing and of contacts into its status.
void ToWire(const Pacing& pacing, const Contacts& contacts, mascot_msgs::msg::Status& status);
/// Reads it again. Throws std::runtime_error if what it tells cannot have been in a run of `agents` agents and
/// `obstacles` obstacles whose last tick is `last_tick`.
void FromWire(const mascot_msgs::msg::Status& status, int agents, std::size_t obstacles, std::int64_t last_tick,
              Pacing& pacing, Contacts& contacts);
Motion FromWire(const mascot_msgs::msg::AgentState& sample);
Command FromWire(const mascot_msgs::msg::AgentCommand& sample);

/// Replaces `bytes` by those that the bus sends for `sample`: a 4-byte encapsulation header, then CDR with zeroed
/// padding. `bytes` keeps its capacity from call to call.
void Serialize(mascot_msgs::msg::AgentState& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::AgentCommand& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::AgentMessage& sample, std::vector<std::uint8_t>& bytes);
void Serialize(rosgraph_msgs::msg::Clock& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::Event& sample, std::vector<std::uint8_t>& bytes);
/// The inverse of Serialize(). Throws std::runtime_error for bytes that are no such sample.
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentState& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentCommand& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentMessage& sample);
void Deserialize(std::span<const std::uint8_t> bytes, rosgraph_msgs::msg::Clock& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::Event& sample);

}  // namespace mascot
