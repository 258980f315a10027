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
#include "experiment/events.h"
#include "idl/topics.h"

namespace mascot {

using StateType = mascot_msgs::msg::AgentStatePubSubType;
using AnswersType = mascot_msgs::msg::AnswersPubSubType;
using BundleType = mascot_msgs::msg::BundlePubSubType;
using RowType = mascot_msgs::msg::TickRowPubSubType;
using CommandType = mascot_msgs::msg::AgentCommandPubSubType;
using MessageType = mascot_msgs::msg::AgentMessagePubSubType;
using ActionType = mascot_msgs::msg::AgentActionPubSubType;
using ClockType = rosgraph_msgs::msg::ClockPubSubType;
using EventType = mascot_msgs::msg::EventPubSubType;
using StatusType = mascot_msgs::msg::StatusPubSubType;
using RequestType = mascot_msgs::msg::RequestPubSubType;
using ExperimentType = mascot_msgs::msg::ExperimentPubSubType;
using VehicleStatusType = mascot_msgs::msg::VehicleStatusPubSubType;

// Where the sequence of a type begins in its bytes, and how many bytes an element has at least (bus/cdr.h).
template <>
struct SequenceOf<MessageType> {
  static constexpr std::size_t kAt = 24, kElement = sizeof(double);
};
template <>
struct SequenceOf<ActionType> : SequenceOf<MessageType> {};
template <>
struct SequenceOf<StatusType> {
  static constexpr std::size_t kAt = 4, kElement = 44;
};
template <>
struct SequenceOf<ExperimentType> {
  static constexpr std::size_t kAt = 4, kElement = 24;
};

/// Values of Status::state: where a process is in its life cycle.
enum class Life : std::uint8_t { kWaiting = 0, kMatching, kReady, kRunning, kDone, kFailed, kEnded };
/// Whether `life` is a final state: done, failed or ended.
constexpr bool IsLast(Life life) { return life >= Life::kDone; }
/// The state in `status`. Throws std::runtime_error if there is no such state, or if the status has a tick beyond
/// last_tick + 1. `last_tick` is the last tick of the run.
Life CheckedLife(const mascot_msgs::msg::Status& status, std::int64_t last_tick);
/// Values of Request::kind: what the orchestrator asks of a process.
enum class Ask : std::uint8_t {
  kReport = 0,
  kStop,
  kEnd,
  kPause,
  kResume,
  kStep,
  kPace,
  kEvent,
  kLose,
  kStart,
  kLand,
  kStopMotors
};
/// Values of Status::request_tick for a request that took effect at no tick: kOver, the run was over; kTooLate, an
/// event came too late.
inline constexpr std::int64_t kOver = -1, kTooLate = -2;

/// A number that two processes compare to know that they fly the same experiment: the FNV-1a hash of its text. Never 0.
std::uint64_t DigestOf(const mascot_msgs::msg::Experiment& experiment);

/// The DDS type name of the samples on topics of this kind, such as "mascot_msgs::msg::dds_::AgentState_".
std::string WireTypeName(TopicKind kind);

/// Simulated time of `tick` in nanoseconds: tick / rate_hz, rounded to the nearest; never a sum of rounded periods.
std::uint64_t StampNs(std::int64_t tick, int rate_hz);

/// The tick of a sample on `topic`, from the fields `agent` and `tick` of the sample. Throws std::runtime_error if
/// `topic` is not that agent's, or if the tick is beyond `last_tick`, the last tick of the run.
std::int64_t CheckedTick(const Topic& topic, std::uint32_t agent, std::uint64_t tick, std::int64_t last_tick);

// The only conversions between our types and the types of the wire. Units and frames are the same on both sides (SI;
// W and B as in base/motion.h); quaternions are x, y, z, w on the wire. ToWire() overwrites all fields of
// `sample`, whose stamp becomes the time of `tick` at `rate_hz`; agents are numbered from 1.
/// The state of an agent. `events` is the number of events that have taken effect up to this tick.
void ToWire(std::int64_t tick, int rate_hz, int agent, int events, const Motion& motion,
            mascot_msgs::msg::AgentState& sample);
void ToWire(std::int64_t tick, int rate_hz, int agent, const Command& command, mascot_msgs::msg::AgentCommand& sample);
void ToWire(std::int64_t tick, int rate_hz, int agent, std::span<const double> message,
            mascot_msgs::msg::AgentMessage& sample);
void ToWire(std::int64_t tick, int rate_hz, rosgraph_msgs::msg::Clock& sample);
/// An event with its number and its text as TOML (Event::Toml()).
void ToWire(std::int64_t tick, int rate_hz, int number, const std::string& toml, mascot_msgs::msg::Event& sample);
/// Puts what the physics server reports of its timing and of contacts into its status; other fields of `status` stay.
void ToWire(const Pacing& pacing, const Contacts& contacts, mascot_msgs::msg::Status& status);
/// Reads timing and contacts out of a status of the physics server. Throws std::runtime_error if they are impossible in
/// a run of `agents` agents and `obstacles` obstacles whose last tick is `last_tick`.
void FromWire(const mascot_msgs::msg::Status& status, int agents, std::size_t obstacles, std::int64_t last_tick,
              Pacing& pacing, Contacts& contacts);
Motion FromWire(const mascot_msgs::msg::AgentState& sample);
/// The velocities of the result, which are not on the wire, are 0.
Command FromWire(const mascot_msgs::msg::AgentCommand& sample);
/// The event in a run of `agents` agents. Throws ConfigError, with "event NUMBER" in front, if it is none.
Event FromWire(const mascot_msgs::msg::Event& sample, int agents);
/// Also throws std::runtime_error if the sample is of another event than `number`, or its tick is none of the run,
/// whose last is `last_tick`.
Event FromWire(const mascot_msgs::msg::Event& sample, int agents, int number, std::int64_t last_tick);

/// Replaces `bytes` by the bytes that the bus sends for `sample`: a 4-byte encapsulation header, then CDR with zeroed
/// padding. `bytes` keeps its capacity from call to call.
void Serialize(mascot_msgs::msg::AgentState& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::AgentCommand& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::AgentMessage& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::AgentAction& sample, std::vector<std::uint8_t>& bytes);
void Serialize(rosgraph_msgs::msg::Clock& sample, std::vector<std::uint8_t>& bytes);
void Serialize(mascot_msgs::msg::Event& sample, std::vector<std::uint8_t>& bytes);
/// The inverse of Serialize(). Throws std::runtime_error if `bytes` is not a sample of this type.
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentState& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentCommand& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentMessage& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::AgentAction& sample);
void Deserialize(std::span<const std::uint8_t> bytes, rosgraph_msgs::msg::Clock& sample);
void Deserialize(std::span<const std::uint8_t> bytes, mascot_msgs::msg::Event& sample);

}  // namespace mascot
