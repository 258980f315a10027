#include "orchestrator/serving/binary_form.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <stdexcept>

#include "base/state_numbers.h"
#include "orchestrator/formats/bytes.h"

namespace mascot {
namespace {

std::string FrameOf(FrameKind kind, std::string_view content) {
  const auto length = static_cast<std::uint32_t>(1 + content.size());
  std::string frame(kFrameHead, '\0');
  std::memcpy(frame.data(), &length, sizeof length);
  frame[kFrameLength] = static_cast<char>(kind);
  frame.append(content);
  return frame;
}

}  // namespace

BinaryStep ReadStep(std::span<const std::uint8_t> content, std::size_t action_numbers) {
  BinaryStep step;
  const std::size_t whole = sizeof step.ticks + action_numbers * sizeof(double);
  if (content.size() != sizeof step.ticks && content.size() != whole)
    throw std::invalid_argument(
        fmt::format("step: expected {} bytes, or {} with actions, got {}", sizeof step.ticks, whole, content.size()));
  std::memcpy(&step.ticks, content.data(), sizeof step.ticks);
  step.actions.resize((content.size() - sizeof step.ticks) / sizeof(double));
  if (!step.actions.empty())
    std::memcpy(step.actions.data(), content.data() + sizeof step.ticks, step.actions.size() * sizeof(double));
  return step;
}

std::string StateFrame(const TeamService& team) {
  const SteppedTeam& stepped = team.team();
  const int agents = stepped.experiment().size();
  const std::vector<double> figures = team.Figures();
  const std::uint32_t flags = (stepped.is_over() ? kIsOver : 0u) | (stepped.failure().empty() ? 0u : kHasFailed);
  Bytes content;
  Append(content, stepped.tick());
  Append(content, flags);
  Append(content, static_cast<std::uint32_t>(agents));
  Append(content, static_cast<std::uint32_t>(figures.size()));
  Append(content, AsBytes(std::span<const double>(figures)));
  for (int id = 1; id <= agents; ++id) {
    std::array<double, kStateNumbers> state{};
    StateTo(stepped.row().motions[static_cast<std::size_t>(id - 1)], state);
    Append(content, AsBytes(std::span<const double>(state)));
    Append(content, std::uint32_t{stepped.IsLost(id) ? 1u : 0u});
    const std::vector<int> heard = stepped.HeardBy(id);
    Append(content, static_cast<std::uint32_t>(heard.size()));
    for (const int other : heard) Append(content, static_cast<std::uint32_t>(other));
  }
  return FrameOf(FrameKind::kStep, {reinterpret_cast<const char*>(content.data()), content.size()});
}

std::string JsonFrame(const std::string& json) { return FrameOf(FrameKind::kJson, json); }

}  // namespace mascot
