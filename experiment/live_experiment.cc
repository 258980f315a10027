#include "experiment/live_experiment.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "base/after_last.h"
#include "experiment/live_keys.h"

namespace mascot {
namespace {

constexpr const char* kWhoseKeys[] = {"law", "control"};  // tables of which an agent may have its own

[[noreturn]] void Refuse(const Event& event, const std::string& why) { throw ConfigError({event.where + ": " + why}); }

bool IsOfAgents(const std::string& key) {
  return std::ranges::find(kWhoseKeys, SplitKey(key).first) != std::end(kWhoseKeys);
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

/// The live key that was perhaps meant by `key`, also without the tables around it: "beta" for law.beta.
std::optional<std::string> MeantBy(const std::string& key, const std::vector<LiveKey>& live) {
  std::vector<std::string_view> paths, names;
  for (const LiveKey& other : live) {
    paths.push_back(other.path);
    names.push_back(AfterLast(paths.back(), '.'));
  }
  if (auto nearest = DidYouMean(key, paths)) return nearest;
  const auto nearest = DidYouMean(key, names);
  if (!nearest) return std::nullopt;
  return live[static_cast<std::size_t>(std::ranges::find(names, *nearest) - names.begin())].path;
}

/// Throws ConfigError for an event that the wire does not carry in a few seconds.
void CheckSize(const Event& event) {
  const std::size_t size = event.Toml().size();
  if (size > LiveExperiment::kMaxEventBytes)
    Refuse(event, "expected an event of at most " + std::to_string(LiveExperiment::kMaxEventBytes) +
                      " bytes, as config.toml has it, got " + std::to_string(size));
}

/// The experiment without what an experiment that events have changed does not have.
Experiment WithoutText(const Experiment& start) {
  Experiment now = start;
  now.resolved.clear();
  now.events.clear();
  now.late_phases_s.clear();
  return now;
}

}  // namespace

LiveExperiment::LiveExperiment(const Experiment& start, const LawCatalog* laws, bool checked)
    : laws_(laws), now_(WithoutText(start)), tables_(LiveTablesOf(start.resolved)), places_(start.agents.size()) {
  now_.checked = checked;
  Section document = tables_.Read("config.toml");
  const auto table_of = [](Section& section) {
    return std::make_shared<const Value::Table>(section.Child("law").InTheFile());
  };
  law_tables_[0] = table_of(document);
  for (Section& section : document.Child("agents").Children("override")) {
    const int id = static_cast<int>(section.Integer("id", 1, start.size()));
    if (section.Has("law")) law_tables_[id] = table_of(section);
    places_[static_cast<std::size_t>(id - 1)] = own_.size();
    own_.push_back({.id = id, .has_law = section.Has("law")});
  }
}

const std::shared_ptr<const Experiment>& LiveExperiment::now() const {
  if (shared_ == nullptr && count_ > 0) shared_ = std::make_shared<const Experiment>(now_);
  return shared_;
}

std::map<int, Value> LiveExperiment::OwnValuesOf(const std::string& key, std::size_t most) const {
  std::map<int, Value> values;
  if (!IsOfAgents(key)) return values;
  for (std::size_t k = 0; k < own_.size() && values.size() < most; ++k)
    if (auto value = tables_.Get(OverrideKey(k) + key)) values.emplace(own_[k].id, *std::move(value));
  return values;
}

// All was legal before the event: what is wrong now is its mistake, also where another key shows it.
void LiveExperiment::Take(const Event& event) {
  if (!now_.checked) CheckSize(event);
  const std::vector<Own> own = own_;
  const bool team_had_changed = team_has_changed_;
  try {
    auto cut = CutAfter(event);
    const TouchedTables touched = Put(event);
    Section tables = tables_.Read(event.where);
    tables.Use(ExperimentKeys());
    const std::vector<Change> changes = ReadAgain(touched, tables, Owners(), now_);
    LawsAgain laws;
    if (touched.HasAny("law"))
      laws = ReadLawsAgain(touched, event.law.has_value(), tables, Owners(), WithTheirOwnLaw(), laws_, now_);
    tables.ThrowIfWrong();
    CheckParams(event, laws);
    for (const Change& change : changes) change(now_);
    if (touched.HasAny("law")) laws.Apply(now_);
    if (cut) now_.cut = *std::move(cut);
  } catch (...) {
    tables_.Undo();
    own_ = own;
    team_has_changed_ = team_had_changed;
    throw;
  }
  tables_.Keep();
  if (event.law) BeginLaws(event);
  if (event.fault || event.restart) TakeFault(event);
  shared_.reset();
  ++count_;
}

void LiveExperiment::TakeFault(const Event& event) {
  AgentConfig& agent = now_.agents[static_cast<std::size_t>((event.restart ? *event.restart : event.fault->agent) - 1)];
  AgentFaults& faults = agent.faults;
  const bool was_lost = faults.is_lost();
  const bool is_of_itself = event.restart || event.fault->of == FaultPart::kAgent;
  if (event.restart) {
    Restart(event.tick, faults);
    std::erase_if(restarts_, [&](const auto& restart) { return restart.second == agent.id; });
  } else {
    Begin(*event.fault, event.tick, faults);
  }
  const bool begins_to_lie = event.fault && event.fault->kind == FaultKind::kLie;
  if (is_of_itself && (event.restart || event.fault->kind == FaultKind::kOk || begins_to_lie)) agent.lie.reset();
  if (begins_to_lie) {
    agent.lie = event.fault->false_data;
    agent.lie->from_s = now_.time_s(event.tick);
  }
  if (faults.is_lost() && !was_lost && now_.run.on_agent_loss == OnAgentLoss::kRestart) {
    const auto ticks = std::max<std::int64_t>(1, std::llround(now_.run.restart_after_s * now_.control.rate_hz));
    restarts_.emplace(event.tick + ticks, agent.id);
  }
}

std::vector<Event> LiveExperiment::RestartsAt(std::int64_t tick) const {
  std::vector<Event> events;
  for (const auto& [at, agent] : restarts_)
    if (at == tick)
      events.push_back({.tick = tick, .restart = agent, .after_loss = true, .where = "run.on_agent_loss"});
  return events;
}

std::optional<std::int64_t> LiveExperiment::NextRestart() const {
  return restarts_.empty() ? std::nullopt : std::optional(restarts_.begin()->first);
}

std::optional<std::set<std::pair<int, int>>> LiveExperiment::CutAfter(const Event& event) const {
  if (!event.graph && event.cut.empty() && event.mend.empty()) return std::nullopt;
  const auto require = [&](const Event::Edges& edges) {
    for (const auto& edge : edges)
      if (!now_.graph.Hears(edge.first, edge.second))
        Refuse(event, "expected an edge of the graph (i hears j), got " + EdgeText(edge));
  };
  std::set<std::pair<int, int>> cut = now_.cut;
  if (event.graph) {
    require(*event.graph);
    for (int id = 1; id <= now_.size(); ++id)
      for (const Graph::Neighbour& heard : now_.graph.HeardBy(id)) cut.insert({id, heard.id});
    for (const auto& edge : *event.graph) cut.erase(edge);
  }
  require(event.cut);
  require(event.mend);
  cut.insert(event.cut.begin(), event.cut.end());
  for (const auto& edge : event.mend) cut.erase(edge);
  return cut;
}

std::vector<int> LiveExperiment::Owners() const {
  std::vector<int> ids;
  for (const Own& own : own_) ids.push_back(own.id);
  return ids;
}

std::set<int> LiveExperiment::WithTheirOwnLaw() const {
  std::set<int> alone;
  for (const Own& own : own_)
    if (own.has_law && team_has_changed_) alone.insert(own.id);
  return alone;
}

void LiveExperiment::BeginLaws(const Event& phase) {
  if (phase_tick_ != phase.tick) ++now_.phase;
  phase_tick_ = phase.tick;
  if (laws_ == nullptr) return;
  const int whose = phase.agents.empty() ? 0 : phase.agents.front();
  auto& before = law_tables_[whose];
  const bool goes_on = before != nullptr && GoesOn(*laws_, *before, *phase.law);
  before = std::make_shared<const Value::Table>(*phase.law);
  if (goes_on) return;
  for (AgentConfig& agent : now_.agents)
    if (whose > 0 ? agent.id == whose : !agent.has_own_law) agent.law.since = phase.tick;
}

// --- what an event puts into the tables -----------------------------------------------------------------

TouchedTables LiveExperiment::Put(const Event& event) {
  TouchedTables touched;
  if (event.law) PutLaw(event, touched);
  for (const auto& [key, value] : event.set) {
    CheckKey(event, key);
    Set(event, key, value, touched);
  }
  if (event.go_to && laws_ != nullptr) {
    const AgentConfig& agent = now_.agent(event.go_to->agent);
    const auto target = laws_->GoTo(agent, event.go_to->p_W, now_.time_s(event.tick - agent.law.since));
    if (target.empty())
      Refuse(event, "goto: expected an agent that flies waypoints, or a leader, got agent " + std::to_string(agent.id) +
                        " of law '" + agent.law.name + "'");
    for (const auto& [key, value] : target) SetFor(agent.id, event.where, "law." + key, value, touched);
  }
  return touched;
}

void LiveExperiment::PutLaw(const Event& phase, TouchedTables& touched) {
  team_has_changed_ = team_has_changed_ || phase.agents.empty();
  for (std::size_t k = 0; k < own_.size(); ++k) {
    const bool concerns = phase.agents.empty() ? !own_[k].has_law : phase.agents.front() == own_[k].id;
    if (!concerns) continue;
    tables_.Erase(OverrideKey(k) + "law");
    std::erase_if(own_[k].set, [](const std::string& key) { return IsInside(key, "law"); });
  }
  if (phase.agents.empty()) {
    tables_.Set("law", {*phase.law}, phase.where);
    touched.of_all.insert("law");
  }
  for (const int agent : phase.agents) {
    const std::size_t k = OverrideIndex(agent, phase.where);
    tables_.Set(OverrideKey(k) + "law", {*phase.law}, phase.where);
    touched.own["law"].insert(k);
  }
}

bool LiveExperiment::IsReached(std::size_t k, const std::string& key) const {
  return tables_.Has(OverrideKey(k) + key) || std::ranges::any_of(own_[k].set, [&](const std::string& own) {
           return own == key || IsInside(own, key) || IsInside(key, own);
         });
}

void LiveExperiment::Set(const Event& event, const std::string& key, const Value& value, TouchedTables& touched) {
  if (!event.agents.empty()) {
    if (!IsOfAgents(key)) Refuse(event, "agents: expected none, got some: " + key + " is the same for all");
    for (const int agent : event.agents) SetFor(agent, event.where, key, value, touched);
    return;
  }
  const auto [table, rest] = SplitKey(key);
  const bool is_of_team = table != "law" || laws_ == nullptr || FindRow(KeysOfLaw(*laws_, now_.law.name), rest);
  if (is_of_team) {
    tables_.Set(key, value, event.where);
    touched.of_all.emplace(table);
  }
  if (!IsOfAgents(key)) return;
  for (std::size_t k = 0; k < own_.size(); ++k)
    if (IsReached(k, key)) SetFor(own_[k].id, event.where, key, value, touched);
}

std::size_t LiveExperiment::OverrideIndex(int agent, const std::string& where) {
  std::size_t& place = places_[static_cast<std::size_t>(agent - 1)];
  if (place < own_.size() && own_[place].id == agent) return place;
  place = own_.size();
  own_.push_back({.id = agent});
  tables_.Set(OverrideKey(place) + "id", {std::int64_t{agent}}, where);
  return place;
}

void LiveExperiment::SetFor(int agent, const std::string& where, const std::string& key, const Value& value,
                            TouchedTables& touched) {
  const std::size_t k = OverrideIndex(agent, where);
  const auto set = [&](const std::string& own_key, const Value& own_value) {
    std::vector<std::string>& keys = own_[k].set;
    if (std::ranges::find(keys, own_key) == keys.end()) keys.push_back(own_key);
    tables_.Set(OverrideKey(k) + own_key, own_value, where);
  };
  if (const auto table = TakenOver(k, key)) set(table->first, table->second);
  set(key, value);
  touched.own[std::string(SplitKey(key).first)].insert(k);
}

std::optional<std::pair<std::string, Value>> LiveExperiment::TakenOver(std::size_t k, const std::string& key) const {
  const auto [table, rest] = SplitKey(key);
  if (table != "law" || laws_ == nullptr) return std::nullopt;
  const std::vector<Key> rows = KeysOfLaw(*laws_, now_.agent(own_[k].id).law.name);
  const Key* row = FindRow(rows, rest);
  if (row == nullptr || row->kind != ValueKind::kAny) return std::nullopt;
  const std::string path = "law." + std::string(row->name);
  if (key == path || tables_.Has(OverrideKey(k) + path)) return std::nullopt;
  return std::pair(path, tables_.Get(path).value_or(Value()));
}

// --- what no table says ---------------------------------------------------------------------------------

void LiveExperiment::CheckKey(const Event& event, const std::string& key) const {
  const auto [table, rest] = SplitKey(key);
  if (table == "law" && laws_ == nullptr) return;
  const Key* row = nullptr;
  if (table == "law") {
    std::vector<std::string> names = LawNamesIn(now_);
    if (!event.agents.empty()) names = {now_.agent(event.agents.front()).law.name};
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
  const auto nearest = laws_ != nullptr ? MeantBy(key, LiveKeysOf(now_, *laws_)) : std::nullopt;
  Refuse(event, key + ": unknown key" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : std::string()));
}

void LiveExperiment::CheckParams(const Event& event, const LawsAgain& laws) const {
  const auto is_of_params = [](const auto& entry) { return (entry.first + ".").starts_with("law.params."); };
  if (laws_ == nullptr || std::ranges::none_of(event.set, is_of_params)) return;
  for (const AgentConfig& agent : now_.agents) {
    const bool is_concerned = event.agents.empty() || std::ranges::find(event.agents, agent.id) != event.agents.end();
    if (!is_concerned) continue;
    const std::string reason = laws.Of(agent).params->WhyFixed(*agent.law.params);
    if (!reason.empty()) Refuse(event, "law.params: " + reason);
  }
}

}  // namespace mascot
