#include "orchestrator/live/shown/shown_keys.h"

#include <nlohmann/json.hpp>

#include "agent/laws/laws.h"
#include "experiment/live_keys.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

/// The value of a key that holds numbers, or lists of them: with a point, however it was written.
Value WithPoint(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.data)) return {static_cast<double>(*integer)};
  const auto* list = std::get_if<Value::List>(&value.data);
  if (list == nullptr) return value;
  Value::List numbers;
  for (const Value& item : *list) numbers.push_back(WithPoint(item));
  return {std::move(numbers)};
}

/// Numbers, booleans, texts and lists of them are written alike in TOML and in JSON; other values, and none, are null.
std::string JsonOf(const Key& row, const std::optional<Value>& value) {
  using enum ValueKind;
  const bool has_points = row.kind == kNumber || row.kind == kVector3 || row.kind == kNumbers || row.kind == kPoints;
  const std::string text = !value ? "null" : ToToml(has_points ? WithPoint(*value) : *value);
  return JsonOrNull<nlohmann::json>(text).is_null() ? "null" : text;
}

}  // namespace

std::vector<ShownKey> ShownKeysOf(const LiveExperiment& live) {
  std::vector<ShownKey> keys;
  for (const LiveKey& key : LiveKeysOf(live.current(), LawTable())) {
    ShownKey& shown = keys.emplace_back(ShownKey{key.path, key.row, JsonOf(key.row, live.ValueOf(key.path))});
    for (const auto& [id, value] : live.OwnValuesOf(key.path, kMaxOwnShown)) shown.own[id] = JsonOf(key.row, value);
  }
  return keys;
}

std::vector<ShownKey> ShownKeysOf(const Experiment& start) {
  return ShownKeysOf(LiveExperiment(start, &LawTable(), /*checked=*/true));
}

}  // namespace mascot
