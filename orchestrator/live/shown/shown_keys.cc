#include "orchestrator/live/shown/shown_keys.h"

#include <nlohmann/json.hpp>

#include "agent/laws/laws.h"
#include "experiment/live_keys.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

/// The value of a dotted key; null: the experiment has none, as of a parameter of another agent's law.
const Value* FindValue(const Value& table, const std::string& path) {
  const std::size_t dot = path.find('.');
  const Value* value = table.Find(path.substr(0, dot));
  return value == nullptr || dot == std::string::npos ? value : FindValue(*value, path.substr(dot + 1));
}

/// Numbers, booleans, texts and lists of them are written alike in TOML and in JSON; other values are null.
std::string JsonOf(const Value* value) {
  const std::string text = value == nullptr ? "null" : ToToml(*value);
  return JsonOrNull<nlohmann::json>(text).is_null() ? "null" : text;
}

}  // namespace

std::vector<ShownKey> ShownKeysOf(const Experiment& now) {
  Section document = Section::FromText(now.resolved, "config.toml");
  std::map<std::string, Value> tables;
  std::vector<ShownKey> keys;
  for (const LiveKey& key : LiveKeysOf(now, LawTable())) {
    const std::size_t dot = key.path.find('.');
    const std::string table = key.path.substr(0, dot);
    const Value& values = tables.try_emplace(table, document.Free(table)).first->second;
    const Value* value = dot == std::string::npos ? &values : FindValue(values, key.path.substr(dot + 1));
    keys.push_back({key.path, key.row, JsonOf(value)});
  }
  return keys;
}

}  // namespace mascot
