#include "orchestrator/serving/team_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "agent/laws/laws.h"
#include "base/state_numbers.h"
#include "base/utf8.h"
#include "experiment/live_keys.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/section.h"
#include "orchestrator/control/json_toml.h"
#include "orchestrator/engines/dds/episodes_over_dds.h"
#include "orchestrator/engines/driven_agents.h"
#include "orchestrator/engines/episodes.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/live/shown/shown_keys.h"
#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/measuring/separation.h"

namespace mascot {
namespace {

using Json = TeamService::Json;

/// A kind of request, and the fields that it may have.
struct RequestKind {
  std::string_view name;
  bool changes = true;
  std::vector<std::string_view> fields = {};
};

const std::vector<RequestKind>& RequestKinds() {
  static const std::vector<RequestKind> kinds = {
      {"hello", false, {"protocol", "form"}},
      {"look", false},
      {"reset", true, {"seed", "set", "ports"}},
      {"step", true, {"actions", "ticks"}},
      {"set", true, {"set", "agents"}},
      {"goto", true, {"agent", "position_m"}},
      {"event", true, {"event"}},
      {"snapshot", false, {"form", "snapshot"}},
      {"restore", true, {"snapshot", "text"}},
      {"forget", false, {"snapshot"}},
      {"close", false},
  };
  return kinds;
}

std::string OrNearest(std::string_view word, std::span<const std::string_view> names) {
  const auto near = DidYouMean(word, names);
  return near ? fmt::format(" (did you mean \"{}\"?)", *near) : std::string();
}

/// The kind of a request, all of whose fields it may have.
const RequestKind& KindOf(const Json& request) {
  OutsideFields fields(request);
  const std::string name = fields.Text("request", 100);
  fields.Require();
  std::vector<std::string_view> names;
  for (const RequestKind& kind : RequestKinds()) names.push_back(kind.name);
  const auto kind = std::ranges::find(RequestKinds(), name, &RequestKind::name);
  if (kind == RequestKinds().end())
    throw std::invalid_argument(
        fmt::format("expected a known \"request\", got \"{}\"{}", name, OrNearest(name, names)));
  for (const auto& [field, value] : request.items()) {
    if (field == "request" || field == "id" || std::ranges::find(kind->fields, field) != kind->fields.end()) continue;
    throw std::invalid_argument(fmt::format("{}: unknown field \"{}\"{}", name, field, OrNearest(field, kind->fields)));
  }
  return *kind;
}

/// Whether a client may set a value: numbers, booleans, lists of them, and one of the names that a key can have. All
/// else could be code, a file or a command, which only who starts the server may bring in.
bool MayBeSet(const std::string& key, const Json& value) {
  if (value.is_array()) return std::ranges::all_of(value, [&](const Json& item) { return MayBeSet(key, item); });
  if (!value.is_string()) return value.is_number() || value.is_boolean();
  const auto [table, rest] = SplitKey(key);
  if (table == "law") {
    for (const LawEntry& law : Laws()) {
      const std::vector<Key> rows = KeysOfLaw(LawTable(), std::string(law.name));
      const Key* const own = FindRow(rows, rest);
      if (own != nullptr && own->kind != ValueKind::kOneOf) return false;
      if (own != nullptr) return true;
    }
    return false;
  }
  const Key* const row = FindRow(ExperimentKeys(), key);
  return row != nullptr && row->kind == ValueKind::kOneOf;
}

/// {"law.p_gain": 0.1} as overrides.
std::vector<Override> SetsIn(const Json& set) {
  constexpr std::string_view kKeyCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.[]-";
  if (!set.is_object()) throw std::invalid_argument("expected an object of keys and values as \"set\"");
  std::vector<Override> sets;
  for (const auto& item : set.items()) {
    const std::string& key = item.key();
    if (key.empty() || key.find_first_not_of(kKeyCharacters) != std::string::npos)
      throw std::invalid_argument(
          fmt::format("set: expected keys such as law.p_gain, got \"{}\"", Shortened(PlainLine(key), 60)));
    if (!MayBeSet(key, item.value()))
      throw std::invalid_argument(
          fmt::format("set {}: expected numbers, true, false, or one of the key's names: texts and tables are given to "
                      "`orchestrator serve --set`, not by clients",
                      key));
    std::string text = ToToml(ValueOf(item.value()));
    std::string origin = fmt::format("set {} = {}", key, Shortened(text, 100));
    sets.push_back({.key = key, .value = std::move(text), .origin = std::move(origin)});
  }
  return sets;
}

std::vector<int> PortsIn(const Json& list) {
  std::vector<int> ports;
  for (const Json& id : list)
    ports.push_back(id.is_number_integer() && id >= 1 && id <= kMaxAgents ? id.get<int>() : 0);
  std::ranges::sort(ports);
  if (!list.is_array() || std::ranges::count(ports, 0) > 0 || std::ranges::adjacent_find(ports) != ports.end())
    throw std::invalid_argument("expected a list of different agents as \"ports\"");
  return ports;
}

/// The action of a port, which has so many numbers.
std::vector<double> ActionIn(const Json& list, const TeamService::Port& port) {
  std::vector<double> numbers;
  for (const Json& number : list)
    if (number.is_number()) numbers.push_back(number.get<double>());
  if (!list.is_array() || numbers.size() != list.size() || numbers.size() != port.numbers)
    throw std::invalid_argument(fmt::format("actions: expected a list of {} numbers for agent {}, got {}", port.numbers,
                                            port.agent, Shortened(list.dump(-1, ' ', true), 100)));
  return numbers;
}

Json ListOf(std::span<const double> numbers) { return std::vector<double>(numbers.begin(), numbers.end()); }

/// `some`, and then `others`.
std::vector<Override> Joined(std::vector<Override> some, std::span<const Override> others) {
  some.insert(some.end(), others.begin(), others.end());
  return some;
}

}  // namespace

TeamService::TeamService(Options options)
    : options_(std::move(options)), start_{.ports = options_.ports}, team_(MakeTeam()) {
  if (!start_.ports.empty()) team_->Reset(Changes(start_));
  Begin();
}

std::unique_ptr<SteppedTeam> TeamService::MakeTeam() {
  if (options_.out) records_.emplace(*options_.out, options_.engine);
  if (options_.engine == kOverDds)
    return std::make_unique<EpisodesOverDds>(
        options_.text, options_.path, options_.overrides,
        EpisodesOverDds::Options{
            .console = *options_.console, .witness = records_ ? &*records_ : nullptr, .may_go_on = options_.may_go_on});
  auto team = std::make_unique<Episodes>(options_.text, options_.path, options_.overrides);
  if (records_) team->SetWitnesses({&*records_});
  return team;
}

bool TeamService::IsChange(const std::string& request) {
  const auto kind = std::ranges::find(RequestKinds(), request, &RequestKind::name);
  return kind != RequestKinds().end() && kind->changes;
}

std::size_t TeamService::action_numbers() const {
  std::size_t numbers = 0;
  for (const Port& port : ports_) numbers += port.numbers;
  return numbers;
}

std::vector<Override> TeamService::Changes(const EpisodeStart& start) const {
  const std::vector<Override> sets = SetsIn(start.sets);
  std::vector<Override> changes;
  if (!start.ports.empty())
    changes.push_back(DrivenAgents(options_.text, options_.path, Joined(options_.overrides, sets), start.ports));
  changes.insert(changes.end(), sets.begin(), sets.end());
  if (start.seed) changes.push_back({.key = "run.seed", .value = std::to_string(*start.seed), .origin = "seed"});
  return changes;
}

void TeamService::Begin() {
  ports_.clear();
  for (const int id : AgentsThatAct(team_->experiment()))
    ports_.push_back({id, team_->experiment().agent(id).law.params->action});
}

Json TeamService::Answer(const Json& request) {
  const std::string kind(KindOf(request).name);
  Json answer{{"answer", kind}};
  if (request.contains("id")) answer["id"] = request["id"];
  if (kind == "hello") answer.update(Hello());
  if (kind == "reset") answer.update(Reset(request));
  if (kind == "step") answer.update(Step(request));
  if (kind == "set" || kind == "goto") {
    Json event = request;
    event.erase("request");
    event.erase("id");
    answer.update(Take(kind == "set" ? event : Json{{"goto", event}}));
  }
  if (kind == "event") answer.update(Take(request.value("event", Json())));
  if (kind == "snapshot") answer.update(Save(request));
  if (kind == "restore") answer.update(Restore(request));
  if (kind == "forget") answer.update(Forget(request));
  if (kind == "look") answer.update(State());
  return answer;
}

Json TeamService::Hello() const {
  const Experiment& experiment = team_->experiment();
  Json ports = Json::array(), keys = Json::array(), figures = Json::array(), units = Json::object();
  for (const Port& port : ports_) {
    const bool velocity = WantedBy(experiment.agent(port.agent).law) == Wanted::kVelocity;
    ports.push_back({{"agent", port.agent},
                     {"numbers", port.numbers},
                     {"wants", velocity ? "velocity" : "acceleration"},
                     {"unit", velocity ? "m/s" : "m/s^2"}});
  }
  for (const StatePart& part : kStateParts) units[part.name] = part.unit;
  for (const ShownKey& key : ShownKeysOf(experiment))
    keys.push_back({{"key", key.name},
                    {"value", JsonOrNull<Json>(key.value)},
                    {"unit", std::string(UnitOf(key.row))},
                    {"meaning", std::string(key.row.meaning)}});
  for (const Figure& figure : FigureTable())
    figures.push_back({{"name", figure.name}, {"unit", figure.unit}, {"meaning", figure.description}});
  return {{"protocol", kServeProtocol},  {"mascot", MASCOT_VERSION},
          {"name", experiment.run.name}, {"engine", options_.engine},
          {"agents", experiment.size()}, {"rate_hz", experiment.control.rate_hz},
          {"ticks", experiment.ticks()}, {"duration_s", experiment.run.duration_s},
          {"seed", experiment.run.seed}, {"ports", std::move(ports)},
          {"units", std::move(units)},   {"figures", std::move(figures)},
          {"keys", std::move(keys)}};
}

const std::vector<TeamService::Figure>& TeamService::FigureTable() {
  static const std::vector<Figure> table = {
      {"disagreement_m", "m", "largest distance of an agent from what the team agrees on, along law.axes"},
      {"separation_m", "m", "smallest distance of two agents"},
  };
  return table;
}

std::vector<double> TeamService::Figures() const {
  const std::vector<Motion>& motions = team_->row().motions;
  Separation separation;
  separation.Add(motions, std::vector<Axes>(motions.size(), Axes::kXyz));
  const double nearest_m = separation.in_space_m();
  return {DisagreementOf(team_->now(), motions),
          std::isfinite(nearest_m) ? nearest_m : std::numeric_limits<double>::quiet_NaN()};
}

Json TeamService::State() {
  team_->AwaitStates();
  const Experiment& experiment = team_->experiment();
  Json state{{"tick", team_->tick()},
             {"t_s", experiment.time_s(team_->tick())},
             {"over", team_->is_over()},
             {"failure", team_->failure()}};
  for (const StatePart& part : kStateParts) state[part.name] = Json::array();
  Json heard = Json::array(), lost = Json::array(), figures = Json::object();
  for (int id = 1; id <= experiment.size(); ++id) {
    std::array<double, kStateNumbers> numbers{};
    StateTo(team_->row().motions[static_cast<std::size_t>(id - 1)], numbers);
    for (const StatePart& part : kStateParts)
      state[part.name].push_back(ListOf(std::span<const double>(numbers).subspan(part.begin, part.size)));
    heard.push_back(team_->HeardBy(id));
    if (team_->IsLost(id)) lost.push_back(id);
  }
  const std::vector<double> values = Figures();
  for (std::size_t k = 0; k < values.size(); ++k) figures[FigureTable()[k].name] = values[k];
  state["heard"] = std::move(heard);
  state["lost"] = std::move(lost);
  state["figures"] = std::move(figures);
  if (records_) state["recording"] = records_->newest().string();
  return state;
}

Json TeamService::Reset(const Json& request) {
  EpisodeStart start{.sets = request.value("set", start_.sets), .ports = start_.ports};
  if (request.contains("ports")) start.ports = PortsIn(request["ports"]);
  if (request.contains("seed")) {
    OutsideFields fields(request);
    start.seed = static_cast<std::uint64_t>(fields.Integer("seed", 0, std::numeric_limits<std::int64_t>::max()));
    fields.Require();
  }
  team_->Reset(Changes(start));
  start_ = std::move(start);
  Begin();
  return State();
}

std::vector<std::vector<double>> TeamService::ActionsIn(const Json& actions) const {
  std::vector<std::vector<double>> of_ports(ports_.size());
  if (actions.is_null()) return of_ports;
  if (actions.is_object()) {
    for (const auto& item : actions.items()) {
      const std::string& name = item.key();
      const auto port =
          std::ranges::find_if(ports_, [&](const Port& any) { return name == std::to_string(any.agent); });
      if (port == ports_.end())
        throw std::invalid_argument(fmt::format(
            "actions: agent {} takes none; it would with `orchestrator serve --ports`, or \"ports\" of a reset",
            Shortened(PlainLine(name), 20)));
      of_ports[static_cast<std::size_t>(port - ports_.begin())] = ActionIn(item.value(), *port);
    }
    return of_ports;
  }
  if (!actions.is_array()) throw std::invalid_argument("expected a list or an object as \"actions\"");
  const bool is_flat = ports_.size() == 1 && !actions.empty() && actions.front().is_number();
  if (is_flat) return {ActionIn(actions, ports_.front())};
  if (actions.size() != ports_.size())
    throw std::invalid_argument(
        fmt::format("actions: expected one for each of {} ports, got {}", ports_.size(), actions.size()));
  for (std::size_t k = 0; k < ports_.size(); ++k)
    if (!actions[k].is_null()) of_ports[k] = ActionIn(actions[k], ports_[k]);
  return of_ports;
}

Json TeamService::Step(const Json& request) {
  std::int64_t ticks = 1;
  if (request.contains("ticks")) {
    OutsideFields fields(request);
    ticks = fields.Integer("ticks", 0, kMostTicks);
    fields.Require();
  }
  const auto actions = ActionsIn(request.value("actions", Json()));
  team_->AwaitStates();
  for (std::size_t k = 0; k < ports_.size(); ++k)
    if (!actions[k].empty()) Act(ports_[k], actions[k]);
  Step(ticks, {});
  return State();
}

void TeamService::Act(const Port& port, std::span<const double> action) {
  if (!team_->IsLost(port.agent) && team_->now().agent(port.agent).law.params->action > 0)
    team_->Act(port.agent, action);
}

void TeamService::Step(std::int64_t ticks, std::span<const double> actions) {
  if (ticks < 0 || ticks > kMostTicks)
    throw std::invalid_argument(fmt::format("step: expected at most {} ticks, got {}", kMostTicks, ticks));
  team_->AwaitStates();
  if (!actions.empty() && actions.size() != action_numbers())
    throw std::invalid_argument(
        fmt::format("actions: expected {} numbers, or none, got {}", action_numbers(), actions.size()));
  if (!actions.empty())
    for (const Port& port : ports_) {
      Act(port, actions.first(port.numbers));
      actions = actions.subspan(port.numbers);
    }
  if (ticks > 0) team_->GoTo(team_->tick() + ticks, options_.may_go_on);
}

Json TeamService::Take(const Json& event) {
  if (!event.is_object()) throw std::invalid_argument("expected an object as \"event\"");
  std::string toml;  // a key on each line
  for (const auto& [key, value] : event.items()) {
    Value name;
    name.data = key;
    toml += (toml.empty() ? "" : "\n") + ToToml(name) + " = " + ToToml(ValueOf(value));
  }
  team_->AwaitStates();
  team_->Take(toml);
  return {{"tick", team_->tick() + 1}};
}

Json TeamService::Save(const Json& request) {
  const std::string form = request.value("form", Json("number")).is_string() ? request.value("form", "number") : "";
  if (request.contains("snapshot")) {
    if (form != "text") throw std::invalid_argument("a snapshot that is kept is given as \"form\": \"text\"");
    const ServedSnapshot& kept = SnapshotOf(request)->second;
    return {{"tick", kept.flown.tick}, {"text", TextOf(kept)}};
  }
  if (form == "text") return {{"tick", team_->tick()}, {"text", TextOf({start_, team_->Save()})}};
  if (form != "number") throw std::invalid_argument("expected \"number\" or \"text\" as \"form\"");
  if (snapshots_.size() == kMostSnapshots)
    throw std::runtime_error(fmt::format("{} snapshots are kept: forget one first", kMostSnapshots));
  snapshots_[next_snapshot_] = {start_, team_->Save()};
  return {{"tick", team_->tick()}, {"snapshot", next_snapshot_++}};
}

Json TeamService::Restore(const Json& request) {
  ServedSnapshot snapshot;
  if (request.contains("text")) {
    OutsideFields fields(request);
    const std::string text = fields.Text("text", std::size_t{1} << 24);
    fields.Require();
    snapshot = SnapshotFrom(text);
    snapshot.flown.changes = Changes(snapshot.start);
  } else {
    snapshot = SnapshotOf(request)->second;
  }
  team_->Restore(snapshot.flown, {});
  start_ = std::move(snapshot.start);
  Begin();
  return State();
}

Json TeamService::Forget(const Json& request) {
  snapshots_.erase(SnapshotOf(request));
  return Json::object();
}

std::map<std::int64_t, ServedSnapshot>::const_iterator TeamService::SnapshotOf(const Json& request) const {
  OutsideFields fields(request);
  const std::int64_t number = fields.Integer("snapshot", 1, std::numeric_limits<std::int64_t>::max());
  fields.Require();
  const auto found = snapshots_.find(number);
  if (found == snapshots_.end()) throw std::invalid_argument(fmt::format("there is no snapshot {}", number));
  return found;
}

}  // namespace mascot
