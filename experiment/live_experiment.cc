#include "experiment/live_experiment.h"

#include <algorithm>
#include <utility>

namespace mascot {
namespace {

constexpr const char* kWhoseKeys[] = {"law", "control"};  // tables of which an agent may have its own

[[noreturn]] void Refuse(const Event& event, const std::string& why) { throw ConfigError({event.where + ": " + why}); }

std::pair<std::string, std::string> SplitFirst(const std::string& path) {
  const std::size_t dot = path.find('.');
  return {path.substr(0, dot), dot == std::string::npos ? "" : path.substr(dot + 1)};
}

bool IsOfAgents(const std::string& key) {
  return std::ranges::find(kWhoseKeys, SplitFirst(key).first) != std::end(kWhoseKeys);
}

/// The row of the dotted key `path` in `rows`; null if there is none. Inside a table whose keys the user chooses, every
/// key has the row of that table.
const Key* FindRow(std::span<const Key> rows, const std::string& path) {
  const auto [name, rest] = SplitFirst(path);
  const auto row = std::ranges::find(rows, name, &Key::name);
  if (row == rows.end()) return nullptr;
  if (rest.empty() || row->kind == ValueKind::kAny) return &*row;
  return row->kind == ValueKind::kTable ? FindRow(row->keys, rest) : nullptr;
}

std::vector<Key> KeysOfLaw(const LawCatalog& laws, const std::string& law) {
  std::vector<Key> rows(LawKeys().begin(), LawKeys().end());
  for (const Key& row : laws.Parameters(law)) {  // a law may describe `leader` more closely
    const auto common = std::ranges::find(rows, row.name, &Key::name);
    if (common == rows.end())
      rows.push_back(row);
    else
      *common = row;
  }
  return rows;
}

void AddLive(const std::string& prefix, std::span<const Key> rows, std::vector<LiveKey>& live) {
  for (const Key& row : rows) {
    const std::string path = prefix.empty() ? std::string(row.name) : prefix + "." + std::string(row.name);
    const bool known = std::ranges::any_of(live, [&](const LiveKey& other) { return other.path == path; });
    if (row.live && !known) live.push_back({path, row});
    if (row.kind == ValueKind::kTable) AddLive(path, row.keys, live);
  }
}

/// The names of all laws in the experiment, the team's first.
std::vector<std::string> LawsIn(const Experiment& experiment) {
  std::vector<std::string> names{experiment.law.name};
  for (const AgentConfig& agent : experiment.agents)
    if (std::ranges::find(names, agent.law.name) == names.end()) names.push_back(agent.law.name);
  return names;
}

/// Appends the dotted names of what is in the table `value`, and in the tables inside it.
void AddKeys(const std::string& name, const Value& value, std::vector<std::string>& keys) {
  for (const auto& [key, inner] : std::get<Value::Table>(value.data)) {
    const std::string path = name + "." + key;
    keys.push_back(path);
    if (std::holds_alternative<Value::Table>(inner.data)) AddKeys(path, inner, keys);
  }
}

std::string EdgeText(const std::pair<int, int>& edge) {
  return "[" + std::to_string(edge.first) + ", " + std::to_string(edge.second) + "]";
}

}  // namespace

std::vector<LiveKey> LiveKeysOf(const Experiment& experiment, const LawCatalog& laws) {
  std::vector<LiveKey> live;
  for (const Key& row : ExperimentKeys()) {
    if (row.name != "law")
      AddLive("", {&row, 1}, live);
    else
      for (const std::string& law : LawsIn(experiment)) AddLive("law", KeysOfLaw(laws, law), live);
  }
  return live;
}

LiveExperiment::LiveExperiment(const Experiment& start, const LawCatalog* laws, bool checked)
    : start_(start), laws_(laws), checked_(checked), text_(start.resolved), changes_{{.key = "events", .value = "[]"}} {
  Section document = Section::FromText(text_, "config.toml");
  document.Use(ExperimentKeys());
  for (Section& section : document.Child("agents").Children("override")) {
    Own own{.id = static_cast<int>(section.Integer("id")), .keys = {}};
    for (const char* table : kWhoseKeys) {
      AddKeys(table, section.Free(table), own.keys);
    }
    own_.push_back(std::move(own));
  }
}

Event LiveExperiment::Parse(std::int64_t tick, const std::string& toml, const std::string& where) const {
  Section section = Section::FromWords(toml, where);
  section.Use(EventKeys());
  Event event = ReadEvent(section, start_.size());
  section.Done();
  section.ThrowIfWrong();
  event.tick = tick;
  return event;
}

std::shared_ptr<const Experiment> LiveExperiment::Take(const Event& event) {
  const std::vector<Own> own = own_;
  try {
    const auto cut = CutAfter(event);
    std::vector<Override> changes = changes_;
    for (Override& change : Changes(event)) {
      std::erase_if(changes, [&](const Override& older) { return older.key == change.key; });
      changes.push_back(std::move(change));
    }
    Section document = Section::FromText(text_, "config.toml", changes);
    Experiment next = laws_ != nullptr ? ReadExperiment(std::move(document), *laws_, start_.run.name, checked_)
                                       : ReadWithoutLaws(std::move(document), start_.run.name);
    next.cut = cut;
    now_ = std::make_shared<const Experiment>(std::move(next));
    changes_ = std::move(changes);
    events_.push_back(event);
    return now_;
  } catch (...) {
    own_ = own;
    throw;
  }
}

std::set<std::pair<int, int>> LiveExperiment::CutAfter(const Event& event) const {
  const auto require = [&](const Event::Edges& edges) {
    for (const auto& edge : edges)
      if (!start_.graph.Hears(edge.first, edge.second))
        Refuse(event, "expected an edge of the graph (i hears j), got " + EdgeText(edge));
  };
  std::set<std::pair<int, int>> cut = current().cut;
  if (event.graph) {
    require(*event.graph);
    for (int id = 1; id <= start_.size(); ++id)
      for (const Graph::Neighbour& heard : start_.graph.HeardBy(id)) cut.insert({id, heard.id});
    for (const auto& edge : *event.graph) cut.erase(edge);
  }
  require(event.cut);
  require(event.mend);
  cut.insert(event.cut.begin(), event.cut.end());
  for (const auto& edge : event.mend) cut.erase(edge);
  return cut;
}

std::vector<Override> LiveExperiment::Changes(const Event& event) {
  std::vector<Override> changes;
  for (const auto& [key, value] : event.set) {
    CheckKey(event, key);
    Set(event, key, value, changes);
  }
  if (event.go_to && laws_ != nullptr) {
    const AgentConfig& agent = current().agent(event.go_to->agent);
    const auto target = laws_->GoTo(agent, event.go_to->p_W, current().time_s(event.tick));
    if (target.empty())
      Refuse(event, "goto: expected an agent that flies waypoints, or a leader, got agent " + std::to_string(agent.id) +
                        " of law '" + agent.law.name + "'");
    for (const auto& [key, value] : target) SetFor(agent.id, event.where, "law." + key, value, changes);
  }
  return changes;
}

void LiveExperiment::CheckKey(const Event& event, const std::string& key) const {
  if (laws_ == nullptr) return;
  const auto [table, rest] = SplitFirst(key);
  const Key* row = nullptr;
  if (table == "law") {
    std::vector<std::string> names = LawsIn(current());
    if (!event.agents.empty()) names = {current().agent(event.agents.front()).law.name};
    for (const std::string& name : names) {
      const std::vector<Key> rows = KeysOfLaw(*laws_, name);
      row = FindRow(rows, rest);
      if (row != nullptr && row->kind == ValueKind::kAny) CheckParams(event);
      if (row != nullptr && row->live) return;
      if (row != nullptr) break;
    }
  } else {
    row = FindRow(ExperimentKeys(), key);
    if (row != nullptr && row->live) return;
  }
  if (row != nullptr) Refuse(event, key + ": expected a live key, got one that no event changes");
  const std::vector<LiveKey> live = LiveKeysOf(current(), *laws_);
  std::vector<std::string_view> names;
  for (const LiveKey& other : live) names.push_back(other.path);
  const auto nearest = DidYouMean(key, names);
  Refuse(event, key + ": unknown key" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : std::string()));
}

void LiveExperiment::CheckParams(const Event& event) const {
  for (const AgentConfig& agent : start_.agents) {
    const bool is_concerned = event.agents.empty() || std::ranges::find(event.agents, agent.id) != event.agents.end();
    if (is_concerned && !agent.law.params->fixed.empty()) Refuse(event, "law.params: " + agent.law.params->fixed);
  }
}

void LiveExperiment::Set(const Event& event, const std::string& key, const Value& value,
                         std::vector<Override>& changes) {
  if (!event.agents.empty()) {
    if (!IsOfAgents(key)) Refuse(event, "agents: expected none, got some: " + key + " is the same for all");
    for (const int agent : event.agents) SetFor(agent, event.where, key, value, changes);
    return;
  }
  const auto [table, rest] = SplitFirst(key);
  const bool is_of_team = table != "law" || laws_ == nullptr || FindRow(KeysOfLaw(*laws_, start_.law.name), rest);
  if (is_of_team) changes.push_back({.key = key, .value = ToToml(value), .origin = event.where});
  for (std::size_t k = 0; k < own_.size(); ++k)
    if (std::ranges::find(own_[k].keys, key) != own_[k].keys.end())
      SetFor(own_[k].id, event.where, key, value, changes);
}

void LiveExperiment::SetFor(int agent, const std::string& where, const std::string& key, const Value& value,
                            std::vector<Override>& changes) {
  const auto found = std::ranges::find(own_, agent, &Own::id);
  const std::string path = "agents.override[" + std::to_string(found - own_.begin()) + "].";
  if (found == own_.end()) {
    own_.push_back({.id = agent, .keys = {}});
    changes.push_back({.key = path + "id", .value = std::to_string(agent), .origin = where, .extends = true});
  }
  changes.push_back({.key = path + key, .value = ToToml(value), .origin = where, .extends = true});
}

}  // namespace mascot
