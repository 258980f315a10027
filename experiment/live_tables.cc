#include "experiment/live_tables.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "experiment/control.h"
#include "experiment/live_keys.h"
#include "experiment/read_experiment.h"

namespace mascot {
namespace {

/// A table that is the same for all agents, and how what is live in it is read again.
struct LiveTable {
  std::string_view name;
  Change (*read)(Section& table, const Experiment& now);
};

constexpr LiveTable kLiveTables[] = {
    {"run",
     [](Section& run, const Experiment& now) -> Change {
       return [pace = ReadPace(run, now.run.mode)](Experiment& next) { next.run.pace = pace; };
     }},
    {"physics",
     [](Section& physics, const Experiment& /*now*/) -> Change {
       return [wind = ReadWind(physics.Child("wind"))](Experiment& next) { next.physics.wind = wind; };
     }},
    {"graph",
     [](Section& graph, const Experiment& /*now*/) -> Change {
       return [range_m = ReadRange(graph)](Experiment& next) { next.schedule = next.schedule.WithRange(range_m); };
     }},
    {"link",
     [](Section& link, const Experiment& now) -> Change {
       return [links = ReadLinks(link, now.graph)](Experiment& next) { next.links = links; };
     }},
};

ControlConfig ReadControlAgain(Section& control) {
  AgentConfig agent;  // with gains and limits that no event changes
  ReadControl(control, {&agent, 1});
  return agent.control;
}

/// Agents' own control tables inherit from [control].
Change ReadControls(const TouchedTables& touched, Section& tables, const std::vector<int>& owners) {
  Section team = tables.Child("control"), agents = tables.Child("agents");
  const bool of_all = touched.of_all.contains("control");
  const auto own = touched.own.find("control");
  std::optional<ControlConfig> common;
  if (of_all) common = ReadControlAgain(team);
  std::vector<std::pair<int, ControlConfig>> special;
  for (std::size_t k = 0; k < owners.size(); ++k) {
    if (!of_all && !own->second.contains(k)) continue;
    Section section = agents.Child("override", k);
    if (!section.Has("control")) continue;
    Section control = section.Child("control");
    control.InheritFrom(team);
    special.emplace_back(owners[k], ReadControlAgain(control));
  }
  return [common, special = std::move(special)](Experiment& next) {
    for (AgentConfig& agent : next.agents) agent.control = common.value_or(agent.control);
    for (const auto& [id, control] : special) next.agents[static_cast<std::size_t>(id - 1)].control = control;
  };
}

/// Moves `key` of `from`, if it is there, to `to`.
void Move(const std::string& key, Value::Table& from, Value::Table& to) {
  const auto found = from.find(key);
  if (found == from.end()) return;
  to[key].data = std::move(found->second.data);
  from.erase(found);
}

/// `table` of `whole`, to be taken apart; an empty one if it is not there.
Value::Table Taken(const std::string& table, Value::Table& whole) {
  const auto found = whole.find(table);
  auto* inner = found != whole.end() ? std::get_if<Value::Table>(&found->second.data) : nullptr;
  return inner != nullptr ? std::move(*inner) : Value::Table();
}

/// The law table inside `whole` without the phases that it has for later.
void MoveLaw(Value::Table& whole, Value::Table& to) {
  if (!whole.contains("law")) return;
  Value::Table law = Taken("law", whole);
  law.erase("schedule");
  to["law"].data = std::move(law);
}

Value::List OwnTables(Value::Table agents) {
  Value::List own;
  if (const auto found = agents.find("override"); found != agents.end())
    for (Value& override : std::get<Value::List>(found->second.data)) {
      auto& whole = std::get<Value::Table>(override.data);
      Value::Table live;
      Move("id", whole, live);
      Move("control", whole, live);
      MoveLaw(whole, live);
      own.emplace_back().data = std::move(live);
    }
  return own;
}

}  // namespace

ValueTables LiveTablesOf(const std::string& resolved) {
  Value::Table whole = Section::FromText(resolved, "config.toml").InTheFile(), live;
  for (const auto& [table, key] : {std::pair("run", "pace"), {"physics", "wind"}, {"graph", "range_m"}}) {
    Value::Table found = Taken(table, whole), kept;
    Move(key, found, kept);
    live[table].data = std::move(kept);
  }
  Value::Table control = Taken("control", whole);
  for (const char* of_processes : {"rate_hz", "python_memory_mb"}) control.erase(of_processes);
  live["control"].data = std::move(control);
  Move("link", whole, live);
  MoveLaw(whole, live);
  Value::Table agents;
  agents["override"].data = OwnTables(Taken("agents", whole));
  live["agents"].data = std::move(agents);
  return ValueTables(live);
}

bool ShareATable(const Event& a, const Event& b) {
  const auto changes = [&](const Event& event, std::string_view table) {
    return (table == "law" && (event.law || event.go_to)) ||
           std::ranges::any_of(event.set, [&](const auto& entry) { return SplitKey(entry.first).first == table; });
  };
  return ((a.law || a.go_to) && changes(b, "law")) ||
         std::ranges::any_of(a.set, [&](const auto& entry) { return changes(b, SplitKey(entry.first).first); });
}

std::vector<Change> ReadAgain(const TouchedTables& touched, Section& tables, const std::vector<int>& owners,
                              const Experiment& now) {
  std::vector<Change> changes;
  for (const LiveTable& table : kLiveTables) {
    if (!touched.of_all.contains(table.name)) continue;
    Section section = tables.Child(table.name);
    changes.push_back(table.read(section, now));
  }
  if (touched.HasAny("control")) changes.push_back(ReadControls(touched, tables, owners));
  return changes;
}

}  // namespace mascot
