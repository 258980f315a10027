#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "orchestrator/serving/team_service.h"

namespace mascot {

// The binary form of steps and states (docs/serve.md): little-endian, without padding. Each message is a frame: u32
// length of what follows, u8 kind, and then the content.

enum class FrameKind : std::uint8_t { kJson = 'J', kStep = 'S' };

/// Length of a frame's length, and of its length and kind.
inline constexpr std::size_t kFrameLength = 4, kFrameHead = 5;

/// A step: how many ticks, and the actions of all ports, one after the other; none: those before hold.
struct BinaryStep {
  std::uint32_t ticks = 0;
  std::vector<double> actions = {};
};
/// Reads the content of a frame kStep. Throws std::invalid_argument if it has another length.
BinaryStep ReadStep(std::span<const std::uint8_t> content, std::size_t action_numbers);

/// Bits of a state's flags.
enum StateFlag : std::uint32_t { kIsOver = 1u << 0, kHasFailed = 1u << 1 };

/// A frame with the state of the team: i64 tick, u32 flags, u32 N agents, u32 F figures, F f64, and for each agent
/// kStateNumbers f64, u32 whether it is lost, u32 count of the agents that it has heard, u32 for each of
/// them.
std::string StateFrame(const TeamService& team);
/// A frame with an answer in JSON.
std::string JsonFrame(const std::string& json);

}  // namespace mascot
