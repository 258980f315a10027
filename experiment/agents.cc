#include "experiment/agents.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "base/enum_names.h"
#include "base/number_rows.h"
#include "experiment/control.h"
#include "experiment/placement.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr Range kPlace_m = {-1e6, 1e6};
constexpr Range kTime_s = {0, 1e6};
constexpr std::string_view kHosts[] = {"local", "external"};

constexpr EnumNames<StartShape, 5> kStartShapes({{StartShape::kBox, "box"},
                                                 {StartShape::kPlane, "plane"},
                                                 {StartShape::kCircle, "circle"},
                                                 {StartShape::kGrid, "grid"},
                                                 {StartShape::kSphere, "sphere"}});

constexpr Key kRandomKeys[] = {
    key::OneOf("shape", kStartShapes.names(),
               "box: anywhere in it; plane: in the box, at the height of min_m; circle: on a horizontal one; grid: on "
               "the points of a horizontal square grid, in random order; sphere: on its surface")
        .Default("\"box\""),
    key::Vector3("min_m", kPlace_m, "a corner of the box in which the agents start; with box and plane")
        .Default("[-10, -10, 1]"),
    key::Vector3("max_m", kPlace_m, "the opposite corner; with box and plane")
        .Otherwise("[10, 10, 4], larger for many agents"),
    key::Vector3("center_m", kPlace_m, "the centre; with circle, grid and sphere")
        .Otherwise("[0, 0, 2], of a sphere higher, so that it is above the ground"),
    key::Number("radius_m", Above(0, 1e6), "with circle and sphere").Otherwise("5.0, larger for many agents"),
    key::Number("grid_spacing_m", Above(0, 1e6), "from a point of the grid to the next; with grid").Default("1.0"),
    key::Number("min_separation_m", {0, 1e6},
                "smallest distance between any two starts; in a box with `law.axes = \"xy\"` in z alone; not with grid")
        .Default("0.5"),
    key::Number("max_speed_m_per_s", {0, 1000},
                "each agent starts with a random velocity, uniform among those up to this speed; horizontal with "
                "`law.axes = \"xy\"`, of unicycles along their heading")
        .Default("0.0"),
    key::Boolean("heading", "whether each agent starts with a random yaw").Default("false"),
};

Key AirframeKey() {
  Key row = key::OneOf("airframe", AirframeNames(), "a built-in airframe, or a table that describes one")
                .Or(ValueKind::kTable);
  row.keys = AirframeKeys();
  return row;
}

/// The vectors of `key`, one per agent; notes a mistake if there are too many or too few.
std::vector<Eigen::Vector3d> OnePerAgent(Section& agents, std::string_view key, std::size_t count) {
  std::vector<Eigen::Vector3d> points = agents.Points(key);
  if (count > 0 && !agents.Wrong(key) && points.size() != count)
    agents.Fail(key, "expected " + std::to_string(count) + " points, one per agent, got a list of " +
                         std::to_string(points.size()));
  points.resize(count, Eigen::Vector3d::Zero());
  return points;
}

/// Notes a mistake about the start of an agent, given its index.
using FailAgent = std::function<void(std::size_t, const std::string&)>;

/// Notes agents that start below the ground, in each other or in an obstacle.
void CheckPlaces(const Experiment& experiment, const FailAgent& fail) {
  const auto& team = experiment.agents;
  for (std::size_t i = 0; i < team.size(); ++i)
    if (experiment.physics.ground && team[i].p_W.z() < 0)
      fail(i, "expected z >= 0 (physics.ground), got " + ShortestFloat(team[i].p_W.z()));
  if (!experiment.physics.collisions) return;
  if (const auto pair = FirstTouching(team))
    fail(static_cast<std::size_t>(pair->second - 1), "expected agents apart (physics.collisions), got agent " +
                                                         std::to_string(pair->second) + " touching agent " +
                                                         std::to_string(pair->first));
  if (const auto hit = FirstInObstacle(team, experiment.physics.obstacles))
    fail(static_cast<std::size_t>(hit->first - 1),
         "expected agents apart from obstacles (physics.obstacles), got agent " + std::to_string(hit->first) +
             " inside obstacle " + std::to_string(hit->second));
}

void ReadPositions(Section& agents, Experiment& experiment) {
  const std::vector<Eigen::Vector3d> points = OnePerAgent(agents, "position_m", experiment.agents.size());
  if (agents.Wrong("position_m")) return;
  for (std::size_t i = 0; i < points.size(); ++i) experiment.agents[i].p_W = points[i];
  CheckPlaces(experiment, [&](std::size_t i, const std::string& words) { agents.FailRow("position_m", i, words); });
}

/// Reads where each agent starts and perhaps its velocity and yaw, from a line each: from a file or where they stand.
void ReadStarts(Section& agents, Experiment& experiment) {
  constexpr std::size_t kWidths[] = {3, 6, 7};
  const bool in_file = agents.Has("starts_file");
  const std::string key = in_file ? "starts_file" : "starts";
  const Section::FileText text =
      in_file ? agents.TextOfFile("starts_file", "starts") : Section::FileText{agents.Text("starts"), ""};
  if (agents.Wrong(key)) return;
  TextPlace at;
  const auto fail = [&](const std::string& mistake) {
    const std::string line = std::to_string(at.line), column = std::to_string(at.column);
    if (in_file)
      agents.FailInText(key, text.name + ":" + line + ":" + column, mistake);
    else
      agents.Fail(key, "line " + line + ", column " + column + ": " + mistake);
  };
  std::vector<NumberRow> rows;
  const std::string mistake =
      ReadNumberRows(text.text, kWidths, "3, 6 or 7 numbers in [-1e+06, 1e+06], x,y,z,vx,vy,vz,heading", rows, at);
  if (!mistake.empty()) return fail(mistake);
  std::vector<AgentConfig>& team = experiment.agents;
  if (team.empty()) return;
  if (rows.size() != team.size())
    return fail("expected " + std::to_string(team.size()) + " lines, one per agent, got " +
                std::to_string(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double>& numbers = rows[i].numbers;
    at = {.line = rows[i].line};
    if (numbers.size() > 3 && agents.Has("velocity_m_per_s"))
      return fail("expected x,y,z alone beside velocity_m_per_s, got " + rows[i].text);
    if (numbers.size() > 6 && agents.Has("heading_rad"))
      return fail("expected no heading beside heading_rad, got " + rows[i].text);
    team[i].p_W = {numbers[0], numbers[1], numbers[2]};
    if (numbers.size() > 3) team[i].v_W = {numbers[3], numbers[4], numbers[5]};
    if (numbers.size() > 6) team[i].heading_rad = numbers[6];
  }
  CheckPlaces(experiment, [&](std::size_t i, const std::string& words) {
    at = {.line = rows[i].line};
    fail(words);
  });
}

/// Number of agents that stand on the ground.
double Standing(const Experiment& experiment) {
  if (!experiment.physics.ground) return 0;
  return static_cast<double>(
      std::ranges::count_if(experiment.agents, [](const AgentConfig& agent) { return agent.traits().rolls; }));
}

std::string InQuotes(StartShape shape) { return '"' + std::string(kStartShapes.Name(shape)) + '"'; }

/// The largest horizontal extent of a body, or the separation if that is more.
double Room_m(const Experiment& experiment, double separation_m) {
  double room_m = separation_m;
  for (const AgentConfig& agent : experiment.agents) room_m = std::max(room_m, agent.size_m().head<2>().norm());
  return room_m;
}

/// The corners of a box. By default it grows with the number of agents: in height, so that flying agents have room
/// above each other, and in length and width, so that agents that are apart in x, y leave four fifths of it free.
void ReadCorners(Section& random, const Experiment& experiment, StartRegion& region) {
  region.min_m = random.Vector3("min_m");
  const bool is_plane = region.shape == StartShape::kPlane;
  const double height_m = is_plane ? 0 : std::max(3.0, 1.2 * region.separation_m * (experiment.size() - 1));
  const double side_m = 2 * region.separation_m * std::sqrt(is_plane ? experiment.size() : Standing(experiment));
  const Eigen::Vector3d usual_m(std::max(10.0, region.min_m.x() + side_m), std::max(10.0, region.min_m.y() + side_m),
                                region.min_m.z() + height_m);
  region.max_m = random.Vector3("max_m", usual_m);
  for (int axis = 0; axis < 3; ++axis)
    if (region.max_m[axis] < region.min_m[axis])
      random.Fail("max_m", "expected at least min_m, got " + std::string(1, "xyz"[axis]) + " = " +
                               ShortestFloat(region.max_m[axis]) + " below " + ShortestFloat(region.min_m[axis]));
  if (is_plane) region.max_m.z() = region.min_m.z();
}

/// Centre and size of a circle, a grid or a sphere. By default agents take a third of the circle, or a fifth of the
/// sphere.
void ReadRound(Section& random, const Experiment& experiment, StartRegion& region) {
  constexpr double kUsual_m = 5;
  const double count = experiment.size(), room_m = Room_m(experiment, region.separation_m);
  const bool is_sphere = region.shape == StartShape::kSphere;
  const double needed_m = is_sphere ? room_m * std::sqrt(count / 3.2) : room_m * count * 3 / (2 * std::numbers::pi);
  Eigen::Vector3d half_m;
  if (region.shape == StartShape::kGrid) {
    region.spacing_m = random.Number("grid_spacing_m");
    half_m = Eigen::Vector3d(1, 1, 0) * (region.spacing_m * (std::ceil(std::sqrt(count)) - 1) / 2);
  } else {
    region.radius_m = random.Number("radius_m", std::max(kUsual_m, std::ceil(needed_m)));
    half_m = Eigen::Vector3d(1, 1, is_sphere ? 1 : 0) * region.radius_m;
  }
  region.center_m = random.Vector3("center_m", Eigen::Vector3d(0, 0, is_sphere ? region.radius_m + 1 : 2));
  region.min_m = region.center_m - half_m;
  region.max_m = region.center_m + half_m;
}

/// Notes the keys that another shape than this one has.
void RefuseOtherKeys(Section& random, StartShape shape) {
  using enum StartShape;
  struct Row {
    std::string_view key;
    std::vector<StartShape> shapes;
  };
  const Row rows[] = {{"min_m", {kBox, kPlane}},
                      {"max_m", {kBox, kPlane}},
                      {"center_m", {kCircle, kGrid, kSphere}},
                      {"radius_m", {kCircle, kSphere}},
                      {"grid_spacing_m", {kGrid}},
                      {"min_separation_m", {kBox, kPlane, kCircle, kSphere}}};
  for (const Row& row : rows) {
    if (!random.Has(row.key) || std::ranges::find(row.shapes, shape) != row.shapes.end()) continue;
    std::string shapes;
    for (const StartShape with : row.shapes) shapes += (shapes.empty() ? "" : " or ") + InQuotes(with);
    random.Fail(row.key, "expected shape = " + shapes + " with it, got " + InQuotes(shape));
    random.Free(row.key);
  }
}

StartRegion ReadRegion(Section& random, const Experiment& experiment) {
  StartRegion region;
  region.shape = kStartShapes.Value(random.OneOf("shape"));
  RefuseOtherKeys(random, region.shape);
  const bool is_box = region.shape == StartShape::kBox;
  region.in_z_alone = is_box && experiment.law.axes == Axes::kXy;
  region.may_touch = !experiment.physics.collisions;
  region.has_ground = experiment.physics.ground;
  region.obstacles = experiment.physics.obstacles;
  if (region.shape != StartShape::kGrid) region.separation_m = random.Number("min_separation_m");
  if (is_box || region.shape == StartShape::kPlane)
    ReadCorners(random, experiment, region);
  else
    ReadRound(random, experiment, region);
  if (!random.Wrong("") && experiment.physics.ground && region.min_m.z() < 0) {
    const bool has_corners = is_box || region.shape == StartShape::kPlane;
    const double lowest_m = region.center_m.z() - region.min_m.z();
    random.Fail(has_corners ? "min_m" : "center_m",
                fmt::format("expected z >= {:g} (physics.ground), got {}", has_corners ? 0 : lowest_m,
                            ShortestFloat(has_corners ? region.min_m.z() : region.center_m.z())));
  }
  if (region.shape == StartShape::kSphere && Standing(experiment) > 0)
    random.Fail("shape", "expected another one than \"sphere\", because unicycles stand on the ground");
  return region;
}

/// What to change if there is no room.
std::string MoreRoom(const StartRegion& region) {
  switch (region.shape) {
    case StartShape::kBox:
      return region.in_z_alone ? "a higher one (max_m), less min_separation_m, or shape = \"plane\""
                               : "a larger one (min_m, max_m) or less min_separation_m";
    case StartShape::kPlane:
      return "a larger one (min_m, max_m) or less min_separation_m";
    case StartShape::kCircle:
    case StartShape::kSphere:
      return "a larger radius_m or less min_separation_m";
    case StartShape::kGrid:
      return "a larger grid_spacing_m";
  }
  return "";
}

void ReadRandom(Section& agents, Experiment& experiment) {
  Section random = agents.Child("random");
  const StartRegion region = ReadRegion(random, experiment);
  const double max_speed_m_per_s = random.Number("max_speed_m_per_s");
  const bool heading = random.Boolean("heading");
  random.Done();
  if (max_speed_m_per_s > 0 && agents.Has("velocity_m_per_s"))
    random.Fail("max_speed_m_per_s", "expected one of velocity_m_per_s, random.max_speed_m_per_s, got both");
  if (heading && agents.Has("heading_rad"))
    random.Fail("heading", "expected one of heading_rad, random.heading, got both");
  if (random.Wrong("")) return;
  const std::uint64_t seed = experiment.run.seed;
  if (heading) DrawHeadings(experiment.agents, seed);
  if (max_speed_m_per_s > 0)
    DrawVelocities(experiment.agents, max_speed_m_per_s, experiment.law.axes == Axes::kXy, seed);
  if (Place(experiment.agents, region, seed)) return;
  const std::string in_z =
      Standing(experiment) > 0 ? " in z (law.axes = \"xy\"; unicycles in x, y)" : " in z (law.axes = \"xy\")";
  const std::string apart = region.shape == StartShape::kGrid ? " that do not touch"
                                                              : " " + ShortestFloat(region.separation_m) + " m apart" +
                                                                    (region.in_z_alone ? in_z : "");
  agents.Fail("random", "expected room for " + std::to_string(experiment.size()) + " agents" + apart +
                            (region.obstacles.empty() ? "" : ", clear of obstacles (physics.obstacles)") +
                            ", got too small a " + std::string(kStartShapes.Name(region.shape)) + "; what helps is " +
                            MoreRoom(region));
}

AgentOverride ReadOverride(Section& section, std::vector<AgentConfig>& agents, std::set<std::int64_t>& seen) {
  const auto last = agents.empty() ? kMaxAgents : static_cast<std::int64_t>(agents.size());
  const std::int64_t id = section.Integer("id", 1, last);
  if (!section.Wrong("id") && !seen.insert(id).second) section.Fail("id", EachOnce("agent", std::to_string(id)));
  AgentConfig unknown;
  AgentConfig& agent = agents.empty() ? unknown : agents[static_cast<std::size_t>(id - 1)];
  if (section.Has("model")) agent.model = section.OneOf("model");
  if (section.Has("airframe")) agent.airframe = ReadAirframe(section, "airframe");
  agent.start_s = section.Number("start_s");
  if (section.Has("stop_s")) {
    agent.stop_s = section.Number("stop_s");
    if (!section.Wrong("stop_s") && !section.Wrong("start_s") && agent.stop_s <= agent.start_s)
      section.Fail("stop_s", "expected a time after start_s (" + ShortestFloat(agent.start_s) + "), got " +
                                 ShortestFloat(agent.stop_s));
  }
  agent.external = section.OneOf("host") == "external";
  if (section.Has("lie")) {
    Section lie = section.Child("lie");
    agent.lie = ReadFalseData(lie);
  }
  return {.id = agents.empty() || section.Wrong("id") ? 0 : static_cast<int>(id), .section = section};
}

/// Reads the initial yaws, one per agent.
void ReadHeadings(Section& agents, std::vector<AgentConfig>& team) {
  if (!agents.Has("heading_rad")) return;
  const std::vector<double> headings = agents.Numbers("heading_rad");
  if (!team.empty() && !agents.Wrong("heading_rad") && headings.size() != team.size())
    agents.Fail("heading_rad", "expected " + std::to_string(team.size()) + " numbers, one per agent, got a list of " +
                                   std::to_string(headings.size()));
  for (std::size_t i = 0; i < std::min(headings.size(), team.size()); ++i) team[i].heading_rad = headings[i];
}

/// Reads the targets of each agent.
void ReadWaypoints(Section& agents, std::vector<AgentConfig>& team) {
  if (!agents.Has("waypoints_m")) return;
  const std::vector<std::vector<Eigen::Vector3d>> lists = agents.PointLists("waypoints_m");
  if (!team.empty() && !agents.Wrong("waypoints_m") && lists.size() != team.size())
    agents.Fail("waypoints_m", "expected " + std::to_string(team.size()) + " lists of points, one per agent, got " +
                                   std::to_string(lists.size()));
  for (std::size_t i = 0; i < std::min(lists.size(), team.size()); ++i) team[i].waypoints_W = lists[i];
}

}  // namespace

std::span<const Key> AgentsKeys() {
  static const Key override_keys[] = {
      key::Integer("id", 1, kMaxAgents, "number of the agent that this table is about").Required(),
      key::OneOf("model", ModelNames(), "the agent's model").Otherwise("the team's"),
      AirframeKey().Otherwise("the team's"),
      key::Table("control", AgentControlKeys(),
                 "`[control]` for this agent; keys that are left out are as in `[control]`"),
      key::Table("law", LawKeys(),
                 "a law of the agent's own; if its name is that of `[law]`, or left out, keys that are left out are as "
                 "in `[law]`"),
      key::Number("start_s", kTime_s,
                  "before this time the agent's law is off: the agent comes to rest, and no other agent hears it")
          .Default("0.0"),
      key::Number("stop_s", kTime_s,
                  "from this time on the agent's law is off again; a model driven by acceleration coasts about v / "
                  "`control.velocity_gain` from the speed v")
          .Otherwise("never"),
      key::OneOf("host", kHosts,
                 "external: the agent is started by hand, on this host or another, and the run waits for it")
          .Default("\"local\""),
      key::Table("lie", FalseDataKeys(), "the agent lies: the state and the messages that others hear of it are false"),
  };
  static const Key keys[] = {
      key::Integer("count", 1, kMaxAgents, "number of agents; they are numbered from 1").Required(),
      key::OneOf("model", ModelNames(), "kind of body; `orchestrator models` describes each").Default(DefaultModel()),
      AirframeKey().Default("\"mascot\""),
      key::Points("position_m", kPlace_m, "where each agent starts, in W"),
      key::Table("random", kRandomKeys, "places drawn by `run.seed`; used without the three keys around it"),
      key::Text("starts_file",
                "a file, relative to this one, with a line x,y,z or x,y,z,vx,vy,vz or x,y,z,vx,vy,vz,heading for each "
                "agent (m, m/s, rad), and perhaps a heading"),
      key::Text("starts", "the lines themselves: config.toml of a run has them"),
      key::Points("velocity_m_per_s", {-1000, 1000}, "velocity with which each agent starts, in W")
          .Otherwise("all zero"),
      key::Numbers("heading_rad", {-10, 10}, "yaw with which each agent starts").Otherwise("all zero"),
      key::PointLists(
          "waypoints_m", kPlace_m,
          "for each agent the targets that it flies to, in the place of `law.waypoints_m`; an empty list for an "
          "agent whose law flies to none"),
      key::Tables("override", override_keys, "what is different about one agent"),
  };
  return keys;
}

std::vector<AgentOverride> ReadAgents(Section& agents, int count, Experiment& experiment) {
  AgentConfig common;
  common.model = agents.OneOf("model");
  common.airframe = ReadAirframe(agents, "airframe");
  common.law = experiment.law;
  experiment.agents.assign(static_cast<std::size_t>(count), common);
  for (int id = 1; id <= count; ++id) experiment.agents[static_cast<std::size_t>(id - 1)].id = id;
  std::set<std::int64_t> seen;
  std::vector<AgentOverride> overrides;
  for (Section& section : FewTables(agents, "override", kMaxAgents))
    overrides.push_back(ReadOverride(section, experiment.agents, seen));

  ReadHeadings(agents, experiment.agents);
  ReadWaypoints(agents, experiment.agents);
  agents.TakeOneOf({"position_m", "random", "starts_file", "starts"});
  std::vector<std::string> given;
  for (const char* key : {"position_m", "random", "starts_file", "starts"})
    if (agents.Has(key)) given.emplace_back(key);
  if (given.size() > 1)
    agents.Fail(given.back(), "expected one of position_m, random, starts_file, starts, got " +
                                  (given.size() == 2 ? "both " + given[0] + " and " + given[1]
                                                     : std::to_string(given.size()) + " of them"));
  else if (agents.Has("position_m"))
    ReadPositions(agents, experiment);
  else if (agents.Has("starts_file") || agents.Has("starts"))
    ReadStarts(agents, experiment);
  else
    ReadRandom(agents, experiment);
  if (agents.Has("velocity_m_per_s")) {
    const auto velocities = OnePerAgent(agents, "velocity_m_per_s", experiment.agents.size());
    for (std::size_t i = 0; i < velocities.size(); ++i) experiment.agents[i].v_W = velocities[i];
  }
  agents.Done();
  return overrides;
}

}  // namespace mascot
