#include "orchestrator/serving/snapshot_text.h"

#include <cstring>
#include <limits>
#include <stdexcept>

#include "base/base64.h"
#include "base/number.h"
#include "experiment/experiment.h"
#include "experiment/toml/section.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::size_t kMostItems = 1 << 24;
constexpr std::size_t kLongestKey = 1 << 12, kLongestText = 1 << 24;

std::vector<double> NumbersFrom(const std::string& base64) {
  const auto bytes = FromBase64(base64);
  if (!bytes || bytes->size() % sizeof(double) != 0) throw JsonError("numbers that are not in base64");
  std::vector<double> numbers(bytes->size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes->data(), bytes->size());
  return numbers;
}

/// The actions that were given. Throws JsonError if they are not in the order of ticks, or do not use up `numbers`.
std::vector<Episodes::Snapshot::Given> GivenFrom(const Json& list, std::int64_t last_tick, std::size_t numbers) {
  std::vector<Episodes::Snapshot::Given> all;
  std::int64_t tick = 0;
  std::size_t used = 0;
  for (const Json& item : list) {
    OutsideFields fields(item);
    tick = fields.Integer("tick", tick, last_tick);
    const auto agent = static_cast<int>(fields.Integer("agent", 1, kMaxAgents));
    const auto count =
        static_cast<std::size_t>(fields.Integer("numbers", 0, static_cast<std::int64_t>(numbers - used)));
    fields.Require();
    used += count;
    all.push_back({.tick = tick, .agent = agent, .numbers = count});
  }
  if (used != numbers) throw JsonError("more numbers than actions have");
  return all;
}

}  // namespace

std::string TextOf(const Episodes::Snapshot& snapshot) {
  Json changes = Json::array(), given = Json::array(), events = Json::array();
  for (const Override& change : snapshot.changes)
    changes.push_back({{"key", change.key}, {"value", change.value}, {"origin", change.origin}});
  for (const auto& one : snapshot.given)
    given.push_back({{"tick", one.tick}, {"agent", one.agent}, {"numbers", one.numbers}});
  for (const auto& one : snapshot.events) events.push_back({{"tick", one.tick}, {"toml", one.toml}});
  const std::string_view numbers(reinterpret_cast<const char*>(snapshot.actions.data()),
                                 snapshot.actions.size() * sizeof(double));
  return CompactJson({{"of", std::to_string(snapshot.of)},
                      {"tick", snapshot.tick},
                      {"changes", std::move(changes)},
                      {"given", std::move(given)},
                      {"actions", ToBase64(numbers)},
                      {"events", std::move(events)}});
}

Episodes::Snapshot SnapshotFrom(std::string_view text) try {
  const Json json = ReadJson<Json>(text, {.bytes = kLongestText, .depth = 4});
  if (!json.is_object()) throw JsonError("no object");
  OutsideFields fields(json);
  Episodes::Snapshot snapshot;
  const std::string of = fields.Text("of", 20);
  snapshot.tick = fields.Integer("tick", 0, kMost);
  snapshot.actions = NumbersFrom(fields.Text("actions", kLongestText));
  for (const Json& item : fields.List("changes", kMostItems)) {
    OutsideFields change(item);
    snapshot.changes.push_back({.key = change.Text("key", kLongestKey),
                                .value = change.Text("value", kLongestText),
                                .origin = change.Text("origin", kLongestText)});
    change.Require();
  }
  snapshot.given = GivenFrom(fields.List("given", kMostItems), snapshot.tick, snapshot.actions.size());
  for (const Json& item : fields.List("events", kMostItems)) {
    OutsideFields event(item);
    const std::int64_t last = snapshot.events.empty() ? 1 : snapshot.events.back().tick;
    snapshot.events.push_back({event.Integer("tick", last, kMost), event.Text("toml", kLongestText)});
    event.Require();
  }
  fields.Require();
  const auto number = NumberFrom<std::uint64_t>(of);
  if (!number) throw JsonError("no number of the experiment");
  snapshot.of = *number;
  return snapshot;
} catch (const JsonError& error) {
  throw std::invalid_argument(std::string("expected a snapshot, got other text: ") + error.what());
}

}  // namespace mascot
