#include "orchestrator/engines/driven_agents.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

/// The law table that actions drive, in the place of `law`; what that lacks of axes and safety is as in `team`.
Value DrivenTable(const Value::Table& law, const Value::Table& team, Axes axes) {
  const auto driven = std::ranges::find(Laws(), true, &LawEntry::is_driven);
  Value::Table table;
  table["name"].data = std::string(driven->name);
  table["axes"].data = std::string(kAxes.Name(axes));
  for (const Value::Table* const from : {&team, &law})
    for (const char* const kept : {"axes", "safety"})
      if (const auto found = from->find(kept); found != from->end()) table[kept] = found->second;
  return {std::move(table)};
}

/// The axes that a law has which says nothing of them.
Axes DefaultAxes(const Value::Table& law) {
  const auto name = law.find("name");
  const auto* named = name == law.end() ? nullptr : std::get_if<std::string>(&name->second.data);
  const auto entry = std::ranges::find_if(Laws(), [&](const LawEntry& any) { return named && any.name == *named; });
  return entry == Laws().end() ? Laws().front().axes : entry->axes;
}

/// Whether the experiment is legal as it is, and somebody takes actions in it.
bool TakesActionsAsItIs(const std::string& text, const std::string& path, std::span<const Override> overrides) try {
  return TakesActions(LoadExperiment(text, path, overrides, UserCode::kNeverRuns));
} catch (const ConfigError&) {  // perhaps because of keys for the law that takes them
  return false;
}

constexpr const char* kOrigin = "the law that takes actions";

}  // namespace

std::vector<Override> WithDrivenTeam(const std::string& text, const std::string& path,
                                     std::vector<Override> overrides) {
  if (TakesActionsAsItIs(text, path, overrides)) return overrides;
  const Value::Table law = Section::FromText(text, path).Child("law").InTheFile();
  overrides.insert(overrides.begin(),
                   {.key = "law", .value = ToToml(DrivenTable(law, {}, DefaultAxes(law))), .origin = kOrigin});
  return overrides;
}

std::vector<int> AgentsThatAct(const Experiment& experiment) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents) {
    if (!agent.takes_actions) continue;
    if (agent.law.params->action == 0)
      throw ConfigError({fmt::format("agent {}: expected a law that takes actions from the start on, or never, got {}",
                                     agent.id, agent.law.name)});
    ids.push_back(agent.id);
  }
  return ids;
}

Override DrivenAgents(const std::string& text, const std::string& path, std::span<const Override> overrides,
                      std::span<const int> ids) {
  constexpr std::string_view kKey = "agents.override";
  for (const Override& override : overrides)
    if (override.key.starts_with(kKey))
      throw ConfigError({"ports: expected no --set of agents.override beside them, got " + override.key});
  const Experiment experiment = LoadExperiment(text, path, overrides, UserCode::kNeverRuns);
  for (const int id : ids)
    if (id < 1 || id > experiment.size())
      throw ConfigError(
          {fmt::format("ports: expected agents of the team, from 1 to {}, got {}", experiment.size(), id)});
  Section file = Section::FromText(text, path, overrides);
  const Value::Table team = file.Child("law").InTheFile();
  Value::List tables;
  std::vector<int> driven;
  const auto law_of = [&](int id, const Value::Table& own) {
    const auto name = own.find("name");
    const bool inherits = name == own.end() || name->second == Value{experiment.law.name};
    return DrivenTable(own, inherits ? team : Value::Table(), experiment.agent(id).law.axes);
  };
  for (Section& section : file.Child("agents").Children("override")) {
    Value::Table table = section.InTheFile();
    const auto id = static_cast<int>(section.Integer("id", 1, experiment.size()));
    if (std::ranges::find(ids, id) != ids.end()) {
      driven.push_back(id);
      const auto law = table.find("law");
      table["law"] = law_of(id, law == table.end() ? Value::Table() : std::get<Value::Table>(law->second.data));
    }
    tables.push_back({std::move(table)});
  }
  for (const int id : ids) {
    if (std::ranges::find(driven, id) != driven.end()) continue;
    Value::Table table;
    table["id"].data = std::int64_t{id};
    table["law"] = law_of(id, {});
    tables.push_back({std::move(table)});
  }
  Value list;
  list.data = std::move(tables);
  return {.key = std::string(kKey), .value = ToToml(list), .origin = "ports"};
}

}  // namespace mascot
