#include "experiment/live_experiment.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "experiment/live_keys.h"

namespace mascot {
namespace {

constexpr const char* kWhoseKeys[] = {"law", "control"};  // tables of which an agent may have its own

[[noreturn]] void Refuse(const Event& event, const std::string& why) { throw ConfigError({event.where + ": " + why}); }

bool IsOfAgents(const std::string& key) {
  return std::ranges::find(kWhoseKeys, SplitFirst(key).first) != std::end(kWhoseKeys);
}

/// The key of override `index`, with which those of its keys begin.
std::string OverrideKey(std::size_t index) { return "agents.override[" + std::to_string(index) + "]."; }

/// Whether a law whose table changes in this way goes on with what it remembers: the same law, but for live keys and
/// the safety filter around it. Tables whose keys the user chooses do not count as live: not every law learns of a
/// change in them.
bool GoesOn(const LawCatalog& laws, const Value::Table& before, const Value::Table& after) {
  const auto name = before.find("name");
  if (name == before.end()) return false;
  const std::vector<Key> rows = KeysOfLaw(laws, std::get<std::string>(name->second.data));
  const auto same = [&](const std::string& key) {
    const Key* row = FindRow(rows, key);
    const bool is_live = row != nullptr && row->live && row->kind != ValueKind::kAny;
    if (is_live || key == "schedule" || key == "safety") return true;
    const auto was = before.find(key), is = after.find(key);
    return was != before.end() && is != after.end() && was->second == is->second;
  };
  const auto all_same = [&](const Value::Table& table) {
    return std::ranges::all_of(table, [&](const auto& entry) { return same(entry.first); });
  };
  return all_same(before) && all_same(after);
}

/// Whether the dotted key `inner` is inside the table `outer`.
bool IsInside(const std::string& inner, const std::string& outer) { return inner.starts_with(outer + "."); }

/// Appends the dotted names of what is in the table `value`, and in the tables inside it.
void AddKeys(const std::string& name, const Value& value, std::vector<std::string>& keys) {
  for (const auto& [key, inner] : std::get<Value::Table>(value.data)) {
    const std::string path = name + "." + key;
    keys.push_back(path);
    if (std::holds_alternative<Value::Table>(inner.data)) AddKeys(path, inner, keys);
  }
}

/// The live key that was perhaps meant by `key`, also without the tables around it: "beta" for law.beta.
std::optional<std::string> MeantBy(const std::string& key, const std::vector<LiveKey>& live) {
  std::vector<std::string_view> paths, names;
  for (const LiveKey& other : live) {
    paths.push_back(other.path);
    names.push_back(paths.back().substr(paths.back().rfind('.') + 1));
  }
  if (auto nearest = DidYouMean(key, paths)) return nearest;
  const auto nearest = DidYouMean(key, names);
  if (!nearest) return std::nullopt;
  return live[static_cast<std::size_t>(std::ranges::find(names, *nearest) - names.begin())].path;
}

/// The table inside `table`; null: there is none.
Value::Table* TableIn(Value::Table* table, const std::string& key) {
  const auto found = table != nullptr ? table->find(key) : Value::Table::iterator();
  return table != nullptr && found != table->end() ? std::get_if<Value::Table>(&found->second.data) : nullptr;
}

/// Takes the schedule out of the law table inside `table`, if there is one.
void EraseSchedule(Value::Table* table) {
  if (Value::Table* law = TableIn(table, "law")) law->erase("schedule");
}

/// The resolved experiment without what happens at a time: that is read once, and not again at each event.
std::string WithoutEvents(const std::string& resolved) {
  Value::Table whole = Section::FromText(resolved, "config.toml").InTheFile();
  whole.erase("events");
  EraseSchedule(&whole);
  if (Value::Table* agents = TableIn(&whole, "agents"); agents != nullptr && agents->contains("override"))
    if (auto* overrides = std::get_if<Value::List>(&agents->at("override").data))
      for (Value& own : *overrides) EraseSchedule(std::get_if<Value::Table>(&own.data));
  std::string text;
  for (const auto& [key, value] : whole) text += key + " = " + ToToml(value) + "\n";
  return text;
}

/// Adds `more` to `changes`, in place of older ones of the same keys. Returns whether there are any.
bool Add(std::vector<Override> more, std::vector<Override>& changes) {
  std::set<std::string_view> keys;
  for (const Override& change : more) keys.insert(change.key);
  std::erase_if(changes, [&](const Override& older) { return keys.contains(older.key); });
  for (std::size_t k = 0; k < more.size(); ++k)  // of one key twice, the later holds
    if (keys.erase(more[more.size() - 1 - k].key) == 0) more[more.size() - 1 - k].key.clear();
  std::ranges::copy_if(more, std::back_inserter(changes), [](const Override& c) { return !c.key.empty(); });
  return !more.empty();
}

/// The law tables of a resolved experiment: at 0 the team's, and those of agents with their own, by id.
std::map<int, Value::Table> LawTablesOf(const std::string& resolved) {
  std::map<int, Value::Table> tables;
  Section document = Section::FromText(resolved, "config.toml");
  document.Use(ExperimentKeys());
  tables[0] = document.Child("law").InTheFile();
  for (Section& section : document.Child("agents").Children("override"))
    if (section.Has("law")) tables[static_cast<int>(section.Integer("id"))] = section.Child("law").InTheFile();
  return tables;
}

}  // namespace

bool LiveExperiment::Own::IsReachedBy(const std::string& key) const {
  return std::ranges::find(keys, key) != keys.end() ||
         std::ranges::any_of(set, [&](const std::string& own) { return IsInside(own, key) || IsInside(key, own); });
}

LiveExperiment::LiveExperiment(const Experiment& start, const LawCatalog* laws, bool checked)
    : start_(start), laws_(laws), checked_(checked), text_(WithoutEvents(start.resolved)) {
  Section document = Section::FromText(text_, "config.toml");
  document.Use(ExperimentKeys());
  law_tables_[0] = document.Child("law").InTheFile();
  since_.resize(start.agents.size());
  places_.resize(start.agents.size());
  for (Section& section : document.Child("agents").Children("override")) {
    Own own{.id = static_cast<int>(section.Integer("id")), .keys = {}, .has_law = section.Has("law")};
    if (own.has_law) law_tables_[own.id] = section.Child("law").InTheFile();
    for (const char* table : kWhoseKeys) AddKeys(table, section.Free(table), own.keys);
    places_[static_cast<std::size_t>(own.id - 1)] = own_.size();
    own_.push_back(std::move(own));
  }
}

Event LiveExperiment::Parse(std::int64_t tick, const std::string& toml, const std::string& where) const {
  Section section = Section::FromWords(toml, where);
  Event event = ReadEventOfRun(section, start_.size());
  section.Done();
  section.ThrowIfWrong();
  event.tick = tick;
  return event;
}

std::shared_ptr<const Experiment> LiveExperiment::Take(const Event& event) {
  const std::vector<Own> own = own_;
  const bool team_had_changed = team_has_changed_;
  try {
    auto cut = CutAfter(event);
    tables_now_.reset();
    std::vector<Override> changes = changes_;
    if (event.law) ForgetLaws(event, changes);
    const bool changes_keys = Add(Changes(event), changes);
    // An event that changes no key, such as one that cuts an edge, leaves all that was read as it is.
    Experiment next = now_ && !changes_keys && !event.law ? *now_ : Read(changes, event.where);
    CheckParams(event, next);
    next.cut = std::move(cut);
    const bool begins_phase = event.law && phase_tick_ != event.tick;
    next.phase = current().phase + (begins_phase ? 1 : 0);
    if (event.law && laws_ != nullptr) BeginLaws(event);
    for (AgentConfig& agent : next.agents) {
      agent.law.since = since_[static_cast<std::size_t>(agent.id - 1)];
      agent.sends_messages = start_.agent(agent.id).sends_messages;
    }
    now_ = std::make_shared<const Experiment>(std::move(next));
    changes_ = std::move(changes);
    if (event.law) phase_tick_ = event.tick;
    ++count_;
    return now_;
  } catch (...) {
    own_ = own;
    team_has_changed_ = team_had_changed;
    throw;
  }
}

// All was legal before the event: what is wrong now is its mistake, also where another key shows it.
Experiment LiveExperiment::Read(std::vector<Override>& changes, const std::string& where) const {
  for (Override& change : changes) change.origin = where;
  Section document = Section::FromWords(text_, where, changes);
  return laws_ != nullptr ? ReadExperiment(std::move(document), *laws_, start_.run.name, checked_, WithTheirOwnLaw())
                          : ReadWithoutLaws(std::move(document), start_.run.name);
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

std::set<int> LiveExperiment::WithTheirOwnLaw() const {
  std::set<int> alone;
  for (const Own& own : own_)
    if (own.has_law && team_has_changed_) alone.insert(own.id);
  return alone;
}

void LiveExperiment::ForgetLaws(const Event& phase, std::vector<Override>& changes) {
  const auto forget = [&](const std::string& table) {
    std::erase_if(changes, [&](const Override& change) { return (change.key + ".").starts_with(table + "."); });
  };
  if (phase.agents.empty()) forget("law");
  team_has_changed_ = team_has_changed_ || phase.agents.empty();
  for (std::size_t k = 0; k < own_.size(); ++k) {
    const bool concerns = phase.agents.empty() ? !own_[k].has_law : phase.agents.front() == own_[k].id;
    if (!concerns) continue;
    forget(OverrideKey(k) + "law");
    for (std::vector<std::string>* keys : {&own_[k].keys, &own_[k].set})
      std::erase_if(*keys, [](const std::string& key) { return IsInside(key, "law"); });
    if (!phase.agents.empty()) AddKeys("law", {*phase.law}, own_[k].keys);
  }
}

void LiveExperiment::BeginLaws(const Event& phase) {
  const int whose = phase.agents.empty() ? 0 : phase.agents.front();
  const bool goes_on = GoesOn(*laws_, law_tables_[whose], *phase.law);
  law_tables_[whose] = *phase.law;
  if (goes_on) return;
  for (const AgentConfig& agent : start_.agents)
    if (whose > 0 ? agent.id == whose : !agent.has_own_law) since_[static_cast<std::size_t>(agent.id - 1)] = phase.tick;
}

std::vector<Override> LiveExperiment::Changes(const Event& event) {
  std::vector<Override> changes;
  if (event.law) {
    const Value table{*event.law};
    if (event.agents.empty()) changes.push_back({.key = "law", .value = ToToml(table), .origin = event.where});
    for (const int agent : event.agents)
      changes.push_back({.key = OverrideKey(OwnOf(agent, event.where, changes)) + "law",
                         .value = ToToml(table),
                         .origin = event.where,
                         .extends = true});
  }
  for (const auto& [key, value] : event.set) {
    CheckKey(event, key);
    Set(event, key, value, changes);
  }
  if (event.go_to && laws_ != nullptr) {
    const AgentConfig& agent = current().agent(event.go_to->agent);
    const auto target = laws_->GoTo(agent, event.go_to->p_W, current().time_s(event.tick - agent.law.since));
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
    std::vector<std::string> names = LawNamesIn(current());
    if (!event.agents.empty()) names = {current().agent(event.agents.front()).law.name};
    for (const std::string& name : names) {
      const std::vector<Key> rows = KeysOfLaw(*laws_, name);
      row = FindRow(rows, rest);
      if (row != nullptr && row->live) return;
      if (row != nullptr) break;
    }
  } else {
    row = FindRow(ExperimentKeys(), key);
    if (row != nullptr && row->live) return;
  }
  if (row != nullptr) Refuse(event, key + ": expected a live key, got one that no event changes");
  const auto nearest = MeantBy(key, LiveKeysOf(current(), *laws_));
  Refuse(event, key + ": unknown key" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : std::string()));
}

void LiveExperiment::CheckParams(const Event& event, const Experiment& next) const {
  const auto is_of_params = [](const auto& entry) { return (entry.first + ".").starts_with("law.params."); };
  if (laws_ == nullptr || std::ranges::none_of(event.set, is_of_params)) return;
  for (const AgentConfig& agent : next.agents) {
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
  const bool is_of_team = table != "law" || laws_ == nullptr || FindRow(KeysOfLaw(*laws_, current().law.name), rest);
  if (is_of_team) changes.push_back({.key = key, .value = ToToml(value), .origin = event.where});
  for (std::size_t k = 0; k < own_.size(); ++k)
    if (own_[k].IsReachedBy(key)) SetFor(own_[k].id, event.where, key, value, changes);
}

std::size_t LiveExperiment::OwnOf(int agent, const std::string& where, std::vector<Override>& changes) {
  std::size_t& place = places_[static_cast<std::size_t>(agent - 1)];
  if (place < own_.size() && own_[place].id == agent) return place;
  const std::size_t index = place = own_.size();
  own_.push_back({.id = agent, .keys = {}});
  changes.push_back(
      {.key = OverrideKey(index) + "id", .value = std::to_string(agent), .origin = where, .extends = true});
  return index;
}

void LiveExperiment::SetFor(int agent, const std::string& where, const std::string& key, const Value& value,
                            std::vector<Override>& changes) {
  const std::size_t index = OwnOf(agent, where, changes);
  const auto set = [&](const std::string& own_key, const Value& own_value) {
    for (std::vector<std::string>* keys : {&own_[index].keys, &own_[index].set})
      if (std::ranges::find(*keys, own_key) == keys->end()) keys->push_back(own_key);
    changes.push_back(
        {.key = OverrideKey(index) + own_key, .value = ToToml(own_value), .origin = where, .extends = true});
  };
  if (const auto table = TakenOver(own_[index], key)) set(table->first, table->second);
  set(key, value);
}

std::optional<std::pair<std::string, Value>> LiveExperiment::TakenOver(const Own& own, const std::string& key) {
  const auto [table, rest] = SplitFirst(key);
  if (table != "law" || laws_ == nullptr) return std::nullopt;
  const std::vector<Key> rows = KeysOfLaw(*laws_, current().agent(own.id).law.name);
  const Key* row = FindRow(rows, rest);
  if (row == nullptr || row->kind != ValueKind::kAny) return std::nullopt;
  const std::string name(row->name), path = table + "." + name;
  const auto is_in_it = [&](const std::string& own_key) { return own_key == path || IsInside(own_key, path); };
  if (key == path || std::ranges::any_of(own.keys, is_in_it)) return std::nullopt;
  if (!tables_now_) tables_now_ = LawTablesOf(current().resolved);
  const auto whose = tables_now_->find(own.id);
  const Value::Table& law = (whose != tables_now_->end() ? whose : tables_now_->find(0))->second;
  const auto value = law.find(name);
  return std::pair(path, value != law.end() ? value->second : Value());
}

}  // namespace mascot
