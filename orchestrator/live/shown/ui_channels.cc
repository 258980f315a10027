#include "orchestrator/live/shown/ui_channels.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "agent/laws/laws.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/theory/survival.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

constexpr EnumNames<RunState::Phase, 4> kPhases({{RunState::Phase::kRunning, "running"},
                                                 {RunState::Phase::kPaused, "paused"},
                                                 {RunState::Phase::kDone, "done"},
                                                 {RunState::Phase::kFailed, "failed"}});
constexpr EnumNames<ValueKind, 15> kKinds({{ValueKind::kNone, "none"},
                                           {ValueKind::kNumber, "number"},
                                           {ValueKind::kInteger, "integer"},
                                           {ValueKind::kBoolean, "boolean"},
                                           {ValueKind::kText, "text"},
                                           {ValueKind::kOneOf, "one_of"},
                                           {ValueKind::kTexts, "texts"},
                                           {ValueKind::kVector3, "vector3"},
                                           {ValueKind::kNumbers, "numbers"},
                                           {ValueKind::kRows, "rows"},
                                           {ValueKind::kPoints, "points"},
                                           {ValueKind::kPointLists, "point_lists"},
                                           {ValueKind::kTable, "table"},
                                           {ValueKind::kTables, "tables"},
                                           {ValueKind::kAny, "any"}});

Json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json ToJson(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }

Json AgentJson(const AgentConfig& agent) {
  const auto places_W = PlacesOf(agent.law);
  const auto pursuit = PursuitFormOf(agent.law);
  const auto i = static_cast<std::size_t>(agent.id - 1);
  Json waypoints = Json::array();
  for (const Eigen::Vector3d& waypoint : WaypointsOf(agent)) waypoints.push_back(ToJson(waypoint));
  const bool is_leader = agent.law.leader == agent.id;
  return {{"id", agent.id},
          {"model", agent.model},
          {"rolls", agent.traits().rolls},
          {"actuator", agent.traits().actuator},
          {"size_m", ToJson(agent.size_m())},
          {"arm_m", agent.traits().has_airframe ? agent.airframe.arm_m : 0.0},
          {"law", agent.law.name},
          {"leads", is_leader || std::ranges::binary_search(HullOf(agent.law), agent.id)},
          {"lies_from_s", agent.lie ? Json(agent.lie->from_s) : Json(nullptr)},
          {"lost", agent.faults.is_lost()},
          {"faults", InWords(agent.faults)},
          {"waypoints_m", waypoints},
          {"place_m", places_W.empty() ? Json(nullptr) : ToJson(places_W[i])},
          {"parent", pursuit ? pursuit->parent[i] : 0},
          {"goto", is_leader || !waypoints.empty()}};
}

/// The table of faults, from which people choose what goes wrong.
Json FaultKindsJson() {
  Json json = Json::array();
  for (const FaultRow& row : FaultRows())
    json.push_back({{"of", kFaultParts.Name(row.of)},
                    {"kind", kFaultKinds.Name(row.kind)},
                    {"parameters", row.parameters},
                    {"meaning", row.meaning}});
  return json;
}

/// What the team can still do in spite of its faults, in words, each entry until the next.
Json SurvivesJson(const Experiment& experiment) {
  Json json = Json::array();
  for (const Survival& survival : SurvivalsOf(experiment))
    json.push_back({{"from_s", experiment.time_s(survival.from)},
                    {"is_wrong", survival.IsAnythingWrong()},
                    {"words", survival.words}});
  return json;
}

/// Agents of which the same is drawn: `of` has it.
template <class Item>
struct DrawnTogether {
  std::span<const Item> of;
  Axes axes;
  std::vector<int> agents;
};

/// What `of` says of the laws of the agents, once for all that agree, with these agents.
template <class Item>
std::vector<DrawnTogether<Item>> Together(const Experiment& experiment,
                                          std::span<const Item> (*of)(const LawConfig& law)) {
  std::vector<DrawnTogether<Item>> all;
  for (const AgentConfig& agent : experiment.agents) {
    const std::span<const Item> own = of(agent.law);
    if (own.empty()) continue;
    const auto same = std::ranges::find_if(all, [&](const DrawnTogether<Item>& other) {
      return other.axes == agent.law.axes && std::ranges::equal(other.of, own);
    });
    if (same != all.end())
      same->agents.push_back(agent.id);
    else
      all.push_back({own, agent.law.axes, {agent.id}});
  }
  return all;
}

/// The regions that agents divide by nearness, each with its agents.
Json CellsJson(const Experiment& experiment) {
  Json json = Json::array();
  for (const auto& [region, axes, agents] : Together(experiment, RegionOf)) {
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner : region) corners.push_back(ToJson(corner));
    json.push_back({{"region_m", corners}, {"agents", agents}});
  }
  return json;
}

/// The agents, as groups, whose convex hull is drawn.
Json HullsJson(const Experiment& experiment) {
  Json json = Json::array();
  for (const auto& [leaders, axes, agents] : Together(experiment, HullOf))
    json.push_back({{"agents", std::vector<int>(leaders.begin(), leaders.end())}, {"axes", kAxes.Name(axes)}});
  return json;
}

bool LeavesOut(const Experiment& experiment) {
  return std::ranges::any_of(LawsIn(experiment), [](const LawEntry* law) { return law->left_out != nullptr; });
}

Json EdgesJson(const Graph& graph) {
  Json edges = Json::array();
  if (graph.edges() > kMaxEdgesShown) return edges;
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& heard : graph.HeardBy(id)) edges.push_back({id, heard.id, heard.weight});
  return edges;
}

Json ObstaclesJson(const std::vector<Obstacle>& obstacles) {
  Json json = Json::array();
  for (const Obstacle& obstacle : obstacles)
    json.push_back({{"kind", kShapes.Name(obstacle.shape)},
                    {"position_m", ToJson(obstacle.p_W)},
                    {"size_m", ToJson(obstacle.size_m)},
                    {"heading_rad", obstacle.heading_rad}});
  return json;
}

Json RecordedJson(const Experiment& experiment, const RecordedPart& recorded) {
  return {{"end_s", experiment.time_s(recorded.last_tick)},
          {"run", recorded.run},
          {"loss", recorded.loss},
          {"incidents", recorded.incidents},
          {"pictures", recorded.pictures},
          {"has_summary", recorded.has_summary}};
}

Json KeysJson(const std::vector<ShownKey>& keys) {
  Json json = Json::array();
  for (const ShownKey& key : keys) {
    const bool is_integer = key.row.kind == ValueKind::kInteger;
    const std::vector<std::string> names(key.row.names.begin(), key.row.names.end());
    Json own = Json::array();
    for (const auto& [id, value] : key.own) own.push_back({{"agent", id}, {"value", JsonOrNull<Json>(value)}});
    json.push_back({{"key", key.name},
                    {"kind", kKinds.Name(key.row.kind)},
                    {"unit", key.row.unit},
                    {"min", is_integer ? static_cast<double>(key.row.min_integer) : key.row.range.min},
                    {"max", is_integer ? static_cast<double>(key.row.max_integer) : key.row.range.max},
                    {"open_min", key.row.range.open_min},
                    {"names", names},
                    {"value", JsonOrNull<Json>(key.value)},
                    {"own", own},
                    {"meaning", key.row.meaning}});
  }
  return json;
}

Json PredictionJson(const Experiment& experiment, const Prediction& prediction, std::int64_t since) {
  return {{"from_s", experiment.time_s(since)},
          {"of_agreement", prediction.of_agreement},
          {"stable", OrNull(prediction.stable)},
          {"value_m", prediction.value_m ? ToJson(*prediction.value_m) : Json(nullptr)},
          {"rate_per_s", OrNull(prediction.rate_per_s)},
          {"slowest_rate_per_s", OrNull(prediction.slowest_rate_per_s)},
          {"settling_time_s", OrNull(prediction.settling_time_s)},
          {"why", prediction.silent}};
}

/// The prediction that is about the values of a curve; null: there is none.
Json PredictedJson(const LawEntry& law, const Prediction& prediction) {
  const auto figure = std::ranges::find(law.figures, law.curve->figure, &LawFigure::name);
  const auto index = static_cast<std::size_t>(figure - law.figures.begin());
  if (index >= prediction.law_figures.size()) return nullptr;
  const PredictedFigure& predicted = prediction.law_figures[index];
  if (predicted.values.size() != 1 || !predicted.values.front()) return nullptr;
  return {{"figure", figure->name}, {"value", *predicted.values.front()}, {"bound", kBounds.Name(predicted.bound)}};
}

/// The curve of the team's law; null: it has none.
Json CurveJson(const Experiment& experiment, const ShownTheory& theory) {
  const LawEntry& law = EntryOf(experiment.law);
  if (!law.curve) return nullptr;
  return {{"name", law.curve->name},
          {"unit", law.curve->unit},
          {"meaning", law.curve->meaning},
          {"decays", law.curve->decays},
          {"agrees", law.agrees},
          {"since_s", experiment.time_s(theory.law_since)},
          {"predicted", PredictedJson(law, theory.prediction)}};
}

Json ResponsesJson(const Experiment& experiment, const std::vector<PartResponse>& responses) {
  Json json = Json::array();
  for (const PartResponse& part : responses) {
    Json values = Json::array();
    for (const double value_m : part.response.value_m) values.push_back(static_cast<float>(value_m));
    json.push_back({{"from_s", experiment.time_s(part.from)},
                    {"until_s", experiment.time_s(part.until)},
                    {"every_s", experiment.time_s(part.response.every)},
                    {"of_ideal_bodies", part.of_ideal_bodies},
                    {"value_m", std::move(values)}});
  }
  return json;
}

/// Writes numbers into JSON, quickly: a frame may have tens of thousands.
class Numbers {
 public:
  explicit Numbers(std::string& out) : out_(out) {}
  void Add(double value) {
    if (!std::isfinite(value)) return AddText("null");
    char text[32];
    const auto end = std::to_chars(std::begin(text), std::end(text), static_cast<float>(value)).ptr;
    AddText({text, end});
  }
  void Add(std::int64_t value) { AddText(std::to_string(value)); }
  void Add(const Eigen::Vector3d& v) {
    for (const double value : v) Add(value);
  }

 private:
  void AddText(std::string_view text) {
    if (out_.back() != '[') out_ += ',';
    out_ += text;
  }
  std::string& out_;
};

/// Appends ,"name":[...]: what `add` adds for each item.
template <class Items, class Add>
void AddList(std::string& out, const char* name, const Items& items, const Add& add) {
  out.append(",\"").append(name).append("\":[");
  Numbers numbers(out);
  for (const auto& item : items) add(numbers, item);
  out += ']';
}

void AddEdges(std::string& out, const Experiment& experiment, const std::vector<EdgeNow>& edges) {
  if (edges.size() != experiment.graph.edges()) {
    out += ",\"edge\":null,\"age_s\":null";
    return;
  }
  AddList(out, "edge", edges, [](Numbers& to, const EdgeNow& edge) { to.Add(static_cast<std::int64_t>(edge.state)); });
  AddList(out, "age_s", edges, [](Numbers& to, const EdgeNow& edge) { to.Add(edge.age_s); });
  if (std::ranges::any_of(edges, [](const EdgeNow& edge) { return edge.left_out != 0; }))
    AddList(out, "left_out", edges, [](Numbers& to, const EdgeNow& edge) { to.Add(std::int64_t{edge.left_out}); });
}

}  // namespace

std::string ExperimentJson(const Experiment& experiment, const ShownTheory& theory, const ShownSource& source,
                           const std::vector<ShownKey>& keys) {
  Json agents = Json::array();
  for (const AgentConfig& agent : experiment.agents) agents.push_back(AgentJson(agent));
  return CompactJson({{"name", experiment.run.name},
                      {"source", source.recorded ? "recording" : "run"},
                      {"engine", source.engine},
                      {"recorded", source.recorded ? RecordedJson(experiment, *source.recorded) : Json(nullptr)},
                      {"rate_hz", experiment.control.rate_hz},
                      {"ticks", experiment.ticks()},
                      {"duration_s", experiment.run.duration_s},
                      {"axes", kAxes.Name(experiment.law.axes)},
                      {"leader", experiment.law.leader},
                      {"agents", agents},
                      {"edges", EdgesJson(experiment.graph)},
                      {"range_m", experiment.schedule.range_m()},
                      {"cells", CellsJson(experiment)},
                      {"hulls", HullsJson(experiment)},
                      {"leaves_out", LeavesOut(experiment)},
                      {"on_agent_loss", kOnAgentLoss.Name(experiment.run.on_agent_loss)},
                      {"fault_kinds", source.recorded ? Json::array() : FaultKindsJson()},
                      {"survives", SurvivesJson(experiment)},
                      {"obstacles", ObstaclesJson(experiment.physics.obstacles)},
                      {"wind_m_per_s", ToJson(experiment.physics.wind.mean_m_per_s)},
                      {"prediction", PredictionJson(experiment, theory.prediction, theory.since)},
                      {"responses", ResponsesJson(experiment, theory.responses)},
                      {"curve", CurveJson(experiment, theory)},
                      {"live_keys", KeysJson(keys)}});
}

std::string FrameJson(const Experiment& experiment, const ShownRow& row, const RunState& state) {
  const auto& motions = row.decoded.motions;
  const auto& commands = row.decoded.commands;
  const Json head = {{"tick", row.tick},
                     {"t_s", experiment.time_s(row.tick)},
                     {"state", kPhases.Name(state.phase)},
                     {"pace", state.pace},
                     {"real_time_factor", state.real_time_factor},
                     {"disagreement_m", row.disagreement_m},
                     {"curve", OrNull(row.curve)},
                     {"contacts", OrNull(state.contacts)}};
  std::string out = CompactJson(head);
  out.pop_back();  // the closing brace
  AddList(out, "p", motions, [](Numbers& to, const Motion& motion) { to.Add(motion.p_WB); });
  AddList(out, "q", motions, [](Numbers& to, const Motion& motion) {
    for (const double value : {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()}) to.Add(value);
  });
  AddList(out, "v", motions, [](Numbers& to, const Motion& motion) { to.Add(motion.v_WB); });
  AddList(out, "speed_m_per_s", motions, [](Numbers& to, const Motion& motion) { to.Add(motion.v_WB.norm()); });
  AddList(out, "a", commands, [](Numbers& to, const Command& command) { to.Add(command.a_limited_W); });
  AddList(out, "u", commands, [](Numbers& to, const Command& command) {
    for (const double value : command.actuator) to.Add(value);
  });
  AddList(out, "flags", commands, [](Numbers& to, const Command& command) { to.Add(std::int64_t{command.flags}); });
  AddEdges(out, experiment, row.edges);
  return out += '}';
}

std::string CurvesJson(const Experiment& experiment, const Curves& curves) {
  std::string out = R"({"rows":[)";
  for (const Curves::Point& point : curves.points()) {
    if (out.back() != '[') out += ',';
    out += '[';
    Numbers numbers(out);
    numbers.Add(experiment.time_s(point.tick));
    numbers.Add(point.disagreement_m);
    numbers.Add(point.of_law.value_or(NAN));  // null
    for (const double speed : point.speeds) numbers.Add(speed);
    out += ']';
  }
  return out += "]}";
}

std::string VehiclesJson(const std::map<int, VehicleNews>& newest) {
  Json list = Json::array();
  for (const auto& [agent, news] : newest)
    list.push_back({{"agent", agent}, {"phase", kFlightPhases.Name(news.phase)}, {"words", news.words}});
  return CompactJson(list);
}

std::string EventsJson(const Experiment& experiment, const std::vector<ShownEvent>& events) {
  Json json = Json::array();
  for (const ShownEvent& event : events)
    json.push_back({{"number", event.number},
                    {"tick", event.tick},
                    {"t_s", experiment.time_s(event.tick)},
                    {"toml", event.toml},
                    {"by_hand", OrNull(event.by_hand)}});
  return CompactJson(json);
}

}  // namespace mascot
