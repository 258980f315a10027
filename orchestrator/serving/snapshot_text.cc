#include "orchestrator/serving/snapshot_text.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "base/base64.h"
#include "base/number.h"
#include "experiment/experiment.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::size_t kMostItems = 1 << 24;
constexpr std::size_t kLongestText = 1 << 24;

std::vector<double> NumbersFrom(const std::string& base64) {
  const auto bytes = FromBase64(base64);
  if (!bytes || bytes->size() % sizeof(double) != 0) throw JsonError("numbers that are not in base64");
  std::vector<double> numbers(bytes->size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes->data(), bytes->size());
  return numbers;
}

/// The actions that were given. Throws JsonError if they are not in the order of ticks, or do not use up `numbers`.
std::vector<SteppedTeam::Snapshot::Given> GivenFrom(const Json& list, std::int64_t last_tick, std::size_t numbers) {
  std::vector<SteppedTeam::Snapshot::Given> all;
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

/// The ports of a text, each once.
std::vector<int> PortsFrom(const Json& list) {
  std::vector<int> ports;
  for (const Json& id : list) {
    if (!id.is_number_integer() || id < 1 || id > kMaxAgents) throw JsonError("ports that are no agents");
    if (std::ranges::find(ports, id.get<int>()) != ports.end()) throw JsonError("a port twice");
    ports.push_back(id.get<int>());
  }
  return ports;
}

}  // namespace

std::string TextOf(const ServedSnapshot& snapshot) {
  const SteppedTeam::Snapshot& flown = snapshot.flown;
  Json given = Json::array(), events = Json::array();
  for (const auto& one : flown.given)
    given.push_back({{"tick", one.tick}, {"agent", one.agent}, {"numbers", one.numbers}});
  for (const auto& one : flown.events) events.push_back({{"tick", one.tick}, {"toml", one.toml}});
  const std::string_view numbers(reinterpret_cast<const char*>(flown.actions.data()),
                                 flown.actions.size() * sizeof(double));
  Json text{{"of", std::to_string(flown.of)}, {"tick", flown.tick},        {"set", snapshot.start.sets},
            {"ports", snapshot.start.ports},  {"given", std::move(given)}, {"actions", ToBase64(numbers)},
            {"events", std::move(events)}};
  if (snapshot.start.seed) text["seed"] = *snapshot.start.seed;
  return CompactJson(text);
}

ServedSnapshot SnapshotFrom(std::string_view text) try {
  const Json json = ReadJson<Json>(text, {.bytes = kLongestText, .depth = 16});
  if (!json.is_object()) throw JsonError("no object");
  OutsideFields fields(json);
  ServedSnapshot snapshot;
  if (fields.Has("seed")) snapshot.start.seed = static_cast<std::uint64_t>(fields.Integer("seed", 0, kMost));
  snapshot.start.ports = PortsFrom(fields.List("ports", kMaxAgents));
  snapshot.start.sets = json.value("set", Json::object());
  SteppedTeam::Snapshot& flown = snapshot.flown;
  const std::string of = fields.Text("of", 20);
  flown.tick = fields.Integer("tick", 0, kMost);
  flown.actions = NumbersFrom(fields.Text("actions", kLongestText));
  flown.given = GivenFrom(fields.List("given", kMostItems), flown.tick, flown.actions.size());
  for (const Json& item : fields.List("events", kMostItems)) {
    OutsideFields event(item);
    const std::int64_t last = flown.events.empty() ? 1 : flown.events.back().tick;
    flown.events.push_back({event.Integer("tick", last, kMost), event.Text("toml", kLongestText)});
    event.Require();
  }
  fields.Require();
  const auto number = NumberFrom<std::uint64_t>(of);
  if (!number) throw JsonError("no number of the experiment");
  flown.of = *number;
  return snapshot;
} catch (const JsonError& error) {
  throw std::invalid_argument(std::string("expected a snapshot, got other text: ") + error.what());
}

}  // namespace mascot
