#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/motion.h"

namespace mascot {

// The per-tick samples as CDR lays them out (idl/mascot.idl), written and read field by field at places that are known
// beforehand: the bytes of Fast CDR, which a test compares, and more than ten times as fast. Agents are numbered from
// 1; units and frames are as in bus/wire.h.
//
// A *body* is a sample without the encapsulation in front. It has this layout where it begins at a multiple of 8 bytes,
// counted from the end of the encapsulation: as a sample of its own, and in the sequences of Bundle, Answers and
// TickRow.

/// What stands in front of each sample: CDR, little-endian.
inline constexpr std::array<std::uint8_t, 4> kEncapsulation = {0, 1, 0, 0};
/// Makes `sample` one with a body of `size` bytes, which it returns.
std::uint8_t* BodyIn(std::vector<std::uint8_t>& sample, std::size_t size);

inline constexpr std::size_t kStateBody = 152, kCommandBody = 104, kClockBody = 8;  // bytes
inline constexpr std::size_t kMaxNumbers = 64;                                      ///< of a message
inline constexpr std::size_t kMaxActionNumbers = 3 + kMaxNumbers;                   ///< of an action
/// Bytes of the body of a message of so many numbers. An action is laid out like a message.
constexpr std::size_t MessageBody(std::size_t numbers) { return 24 + sizeof(double) * numbers; }

/// What the bodies of states, commands, messages and actions begin with.
struct BodyHead {
  std::uint64_t tick = 0;
  std::uint32_t agent = 0;
  std::uint32_t more =
      0;  ///< of a state, the events so far; of a command, its flags; of a message or an action, its numbers
};
BodyHead HeadOf(const std::uint8_t* body);

void PutClock(std::int64_t tick, int rate_hz, std::uint8_t* body);
/// `events`: how many events have taken effect up to this tick.
void PutState(std::int64_t tick, int rate_hz, int agent, int events, const Motion& motion, std::uint8_t* body);
void PutCommand(std::int64_t tick, int rate_hz, int agent, const Command& command, std::uint8_t* body);
void PutMessage(std::int64_t tick, int rate_hz, int agent, std::span<const double> message, std::uint8_t* body);

void GetState(const std::uint8_t* body, Motion& motion);
/// The velocities of a command, which are not on the wire, become 0.
void GetCommand(const std::uint8_t* body, Command& command);
Actuation ActuationOf(const std::uint8_t* command_body);
/// The numbers of a message, of which BodyHead::more says how many.
void GetMessage(const std::uint8_t* body, std::vector<double>& numbers);

}  // namespace mascot
