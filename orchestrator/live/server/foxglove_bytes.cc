#include "orchestrator/live/server/foxglove_bytes.h"

#include <cmath>

#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

/// 4 bytes of encapsulation, which must say little-endian CDR; builtin_interfaces/Time, string, 3 + 4 doubles. CDR
/// aligns after the encapsulation.
std::optional<Goal> GoalFromCdr(std::span<const std::uint8_t> message) {
  constexpr std::size_t kEncapsulation_bytes = 4;
  if (message.size() < kEncapsulation_bytes || message[0] != 0 || message[1] != 1) return std::nullopt;
  ByteReader cdr(message.subspan(kEncapsulation_bytes));
  cdr.Take<std::int32_t>();
  cdr.Take<std::uint32_t>();
  Goal goal;
  goal.frame_id = cdr.TakeText();
  if (!goal.frame_id.empty() && goal.frame_id.back() == '\0') goal.frame_id.pop_back();
  cdr.Align(sizeof(double));
  for (double* number : {&goal.x, &goal.y, &goal.z}) *number = cdr.Take<double>();
  for (int i = 0; i < 4; ++i) cdr.Take<double>();
  return cdr.ok() ? std::optional(goal) : std::nullopt;
}

std::optional<Goal> GoalFromJson(std::span<const std::uint8_t> message) try {
  const auto json = ReadJson<nlohmann::json>(TextOf(message));
  const auto& position = json.at("pose").at("position");
  Goal goal{.frame_id = {}, .x = position.at("x"), .y = position.at("y"), .z = position.at("z")};
  if (json.contains("header")) goal.frame_id = json.at("header").value("frame_id", "");
  return goal;
} catch (const nlohmann::json::exception&) {
  return std::nullopt;
} catch (const JsonError&) {
  return std::nullopt;
}

}  // namespace

std::optional<Goal> ReadGoal(std::string_view encoding, std::span<const std::uint8_t> message) {
  const auto goal = encoding == "cdr" ? GoalFromCdr(message) : GoalFromJson(message);
  const bool is_finite = goal && std::isfinite(goal->x) && std::isfinite(goal->y) && std::isfinite(goal->z);
  return is_finite ? goal : std::nullopt;
}

}  // namespace mascot
