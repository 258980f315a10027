// Every law there is. `orchestrator laws` prints this table.
#include "agent/laws.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

#include "agent/laws/consensus.h"
#include "agent/laws/custom.h"
#include "agent/laws/formation.h"
#include "agent/laws/minmax.h"
#include "agent/laws/plugin.h"
#include "agent/laws/velocity_consensus.h"
#include "agent/laws/waypoint.h"

namespace mascot {

// Defined in agent/laws/<name>.cc.
using LawReader = std::shared_ptr<const LawParams>(const Experiment& experiment, const LawConfig& law,
                                                   Section& section);
using LawFactory = std::unique_ptr<Law>(const Experiment& experiment, int id);
LawReader ReadConsensus, ReadWaypoint, ReadMinmax, ReadFormation, ReadVelocityConsensus, ReadCustom, ReadPlugin;
LawFactory MakeConsensus, MakeWaypoint, MakeMinmax, MakeFormation, MakeVelocityConsensus, MakeCustom, MakePlugin;
using Linearizer = LinearForm(const LawConfig& law);
Linearizer LinearConsensus, LinearWaypoint, LinearFormation, LinearVelocityConsensus;
PursuitForm PursuitOfMinmax(const LawConfig& law);
using Places = std::span<const Eigen::Vector3d>(const LawConfig& law);
Places FormationPlaces_W, WaypointsOfConsensus, WaypointsOfWaypoint, WaypointsOfMinmax, WaypointsOfFormation;
Wanted WantedByCustom(const LawConfig& law);
Wanted WantedByPlugin(const LawConfig& law);
using Guide = std::map<std::string, Value>(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s);
Guide GoToOfConsensus, GoToOfWaypoint, GoToOfMinmax;

namespace {

constexpr std::string_view kAgreement[] = {"disagreement"};
constexpr std::string_view kPursuit[] = {"disagreement", "tracking"};
constexpr std::string_view kFlight[] = {"error"};

constexpr LawEntry kLaws[] = {
    {.name = "consensus",
     .summary = "agents meet, or gather at a leader, by what they hear of their neighbours",
     .equation =
         "a_i = sum_j a_ij [p_gain (p_j - p_i) + v_gain (v_j - v_i)] - beta v_i;  leader: a = 0, or its waypoints",
     .theory =
         "leaderless: meets at g'p(0) + g'v(0) / beta, g the left null vector of L, if a spanning tree exists and "
         "s^2 + (beta + v_gain lambda) s + p_gain lambda is stable for every eigenvalue lambda != 0 of L; "
         "a leader at constant v is followed with a constant lag",
     .source = "Pandit, Njattuvetty, Mulla: MASCOT; Ren & Beard (2008)",
     .parameters = kConsensusParameters,
     .agrees = true,
     .gathers = true,
     .drawing = {.pictures = kAgreement},
     .read = ReadConsensus,
     .make = MakeConsensus,
     .go_to = GoToOfConsensus,
     .waypoints_W = WaypointsOfConsensus,
     .linear = LinearConsensus},
    {.name = "waypoint",
     .summary = "every agent flies the same list of waypoints, by arrival or by time",
     .equation = "a_i = p_gain (w - p_i) - d_gain v_i",
     .theory = "modes s^2 + d_gain s + p_gain; no overshoot from rest for d_gain >= 2 sqrt(p_gain) without limits",
     .source = "Pandit, Njattuvetty, Mulla: MASCOT",
     .parameters = kWaypointParameters,
     .axes = Axes::kXyz,
     .gathers = true,
     .drawing = {.pictures = kFlight},
     .read = ReadWaypoint,
     .make = MakeWaypoint,
     .go_to = GoToOfWaypoint,
     .waypoints_W = WaypointsOfWaypoint,
     .linear = LinearWaypoint},
    {.name = "minmax",
     .summary = "min-max time consensus tracking on a spanning tree of the graph",
     .equation =
         "a_c = -beta_c sgn(2 (beta_c - beta_p) z + w |w|),  z = p_c - p_p,  w = v_c - v_p, per axis;  root: a = "
         "0, or its waypoints",
     .theory = "a child meets a resting parent after sqrt(2 z (1/alpha + 1/beta_c)), any parent within 2 sqrt(z / "
               "alpha), from rest, alpha = beta_c - beta_p > 0",
     .source = "Mulla et al. (2017)",
     .parameters = kMinmaxParameters,
     .agrees = true,
     .gathers = true,
     .drawing = {.leader = "root", .switches = true, .pictures = kPursuit},
     .read = ReadMinmax,
     .make = MakeMinmax,
     .go_to = GoToOfMinmax,
     .waypoints_W = WaypointsOfMinmax,
     .pursuit = PursuitOfMinmax},
    {.name = "formation",
     .summary = "agents keep given displacements from each other, alone or behind a leader",
     .equation = "a_i = -sum_j a_ij [p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j)] - beta v_i;  leader: a = "
                 "0, or its waypoints",
     .theory = "consensus on p_i - d_i: the formation's point meets at the mean of p(0) - d plus that of v(0) / beta "
               "(undirected)",
     .source = "Oh, Park & Ahn (2015); Ren & Atkins (2007)",
     .parameters = kFormationParameters,
     .agrees = true,
     .drawing = {.pictures = kAgreement},
     .read = ReadFormation,
     .make = MakeFormation,
     .places_W = FormationPlaces_W,
     .go_to = GoToOfConsensus,
     .waypoints_W = WaypointsOfFormation,
     .linear = LinearFormation},
    {.name = "velocity_consensus",
     .summary = "single integrators meet: the law wants a velocity",
     .equation = "v_i = p_gain sum_j a_ij (p_j - p_i)",
     .theory =
         "meets at g'p(0), g the left null vector of L, if a spanning tree exists; sampled with period T: p(k+1) = "
         "(I - T p_gain L) p(k), stable for T < 2 / (p_gain lambda_max) (undirected)",
     .source = "Olfati-Saber & Murray (2004)",
     .parameters = kVelocityConsensusParameters,
     .agrees = true,
     .gathers = true,
     .drawing = {.pictures = kAgreement},
     .read = ReadVelocityConsensus,
     .make = MakeVelocityConsensus,
     .wanted = [](const LawConfig&) { return Wanted::kVelocity; },
     .linear = LinearVelocityConsensus},
    {.name = "custom",
     .summary =
         "your own law, in Python: what one agent wants, from what it knows of itself and heard of its neighbours",
     .equation = "control(t, me, neighbours) -> [a_x, a_y, a_z] or [a_x, a_y]",
     .theory = "none: check knows only built-in laws",
     .source = "docs/laws.md",
     .parameters = kCustomParameters,
     .drawing = {.pictures = kAgreement},
     .read = ReadCustom,
     .make = MakeCustom,
     .wanted = WantedByCustom},
    {.name = "plugin",
     .summary = "your own law, in C++: a shared library that is loaded when the experiment is read",
     .equation = "Want_W(t_s, self, heard) -> acceleration or velocity",
     .theory = "none: check knows only built-in laws",
     .source = "docs/plugin_law.md",
     .parameters = kPluginParameters,
     .drawing = {.pictures = kAgreement},
     .read = ReadPlugin,
     .make = MakePlugin,
     .wanted = WantedByPlugin},
};

constexpr auto kLawNames = [] {
  std::array<std::string_view, std::size(kLaws)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kLaws[i].name;
  return names;
}();

const LawEntry& Entry(std::string_view name) {
  const auto* entry = std::ranges::find(kLaws, name, &LawEntry::name);
  if (entry == std::end(kLaws)) throw std::invalid_argument("no law is called \"" + std::string(name) + "\"");
  return *entry;
}

/// The table of laws, for the readers in experiment/.
class Catalog final : public LawCatalog {
 public:
  std::span<const std::string_view> names() const override { return kLawNames; }
  Axes DefaultAxes(std::string_view law) const override { return Entry(law).axes; }
  std::span<const Key> Parameters(std::string_view law) const override { return Entry(law).parameters; }
  std::map<std::string, Value> GoTo(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) const override {
    const LawEntry& entry = Entry(agent.law.name);
    return entry.go_to != nullptr ? entry.go_to(agent, p_W, t_s) : std::map<std::string, Value>();
  }
  std::shared_ptr<const LawParams> Read(const Experiment& experiment, const LawConfig& law,
                                        Section& section) const override {
    const LawEntry& entry = Entry(law.name);
    section.Use(entry.parameters);
    return entry.read(experiment, law, section);
  }
};

}  // namespace

std::span<const LawEntry> Laws() { return kLaws; }

std::span<const std::string_view> LawNames() { return kLawNames; }

const LawEntry& EntryOf(const LawConfig& law) { return Entry(law.name); }

Wanted WantedBy(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.wanted != nullptr ? entry.wanted(law) : Wanted::kAcceleration;
}

bool IsCommandedByVelocity(const AgentConfig& agent) {
  return agent.traits().driven_by == Wanted::kVelocity && WantedBy(agent.law) == Wanted::kVelocity;
}

std::span<const Eigen::Vector3d> PlacesOf(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.places_W != nullptr ? entry.places_W(law) : std::span<const Eigen::Vector3d>();
}

std::span<const Eigen::Vector3d> WaypointsOf(const AgentConfig& agent) {
  const LawEntry& entry = EntryOf(agent.law);
  const bool flies = agent.law.leader == 0 || agent.law.leader == agent.id;
  return entry.waypoints_W != nullptr && flies ? entry.waypoints_W(agent.law) : std::span<const Eigen::Vector3d>();
}

std::optional<LinearForm> LinearFormOf(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.linear != nullptr ? std::optional(entry.linear(law)) : std::nullopt;
}

std::optional<PursuitForm> PursuitFormOf(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.pursuit != nullptr ? std::optional(entry.pursuit(law)) : std::nullopt;
}

std::unique_ptr<Law> MakeLaw(const Experiment& experiment, int id) {
  return EntryOf(experiment.agent(id).law).make(experiment, id);
}

const LawCatalog& LawTable() {
  static const Catalog table;
  return table;
}

Experiment LoadExperiment(Section document, const std::string& default_name, bool checked) {
  return ReadExperiment(std::move(document), LawTable(), default_name, checked);
}

}  // namespace mascot
