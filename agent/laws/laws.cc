// The table of laws: their names in the order in which `orchestrator laws` prints their rows. A row is in the law's own
// file, agent/laws/<folder>/<name>.cc.
#include "agent/laws/laws.h"

#include <algorithm>
#include <stdexcept>

#include "experiment/toml/blame.h"
#include "experiment/toml/input.h"

namespace mascot {

using Row = LawEntry();
Row ConsensusLaw, WaypointLaw, MinmaxLaw, FormationLaw, VelocityConsensusLaw, FiniteTimeLaw, PrescribedTimeLaw,
    RendezvousLaw, EventTriggeredLaw, ContainmentLaw, AverageTrackingLaw, TrajectoryLaw, GradientTrackingLaw,
    CyclicPursuitLaw, DistanceFormationLaw, BearingFormationLaw, PlatoonLaw, PursuitEvasionLaw, CoverageLaw,
    AffineFormationLaw, ResilientLaw, FlockingLaw, AvoidanceLaw, PolicyLaw, ActionsLaw, CustomLaw, OctaveLaw, PluginLaw,
    FmuLaw;

std::span<const LawEntry> Laws() {
  static const LawEntry kLaws[] = {
      ConsensusLaw(),
      WaypointLaw(),
      MinmaxLaw(),
      FormationLaw(),
      VelocityConsensusLaw(),
      FiniteTimeLaw(),
      PrescribedTimeLaw(),
      RendezvousLaw(),
      EventTriggeredLaw(),
      ContainmentLaw(),
      AverageTrackingLaw(),
      TrajectoryLaw(),
      GradientTrackingLaw(),
      CyclicPursuitLaw(),
      DistanceFormationLaw(),
      BearingFormationLaw(),
      PlatoonLaw(),
      PursuitEvasionLaw(),
      CoverageLaw(),
      AffineFormationLaw(),
      ResilientLaw(),
      FlockingLaw(),
      AvoidanceLaw(),
      PolicyLaw(),
      ActionsLaw(),
      CustomLaw(),
      OctaveLaw(),
      PluginLaw(),
      FmuLaw(),
  };
  return kLaws;
}

std::span<const std::string_view> LawNames() {
  static const auto kNames = [] {
    std::vector<std::string_view> names;
    for (const LawEntry& law : Laws()) names.push_back(law.name);
    return names;
  }();
  return kNames;
}

namespace {

const LawEntry& Entry(std::string_view name) {
  const auto entry = std::ranges::find(Laws(), name, &LawEntry::name);
  if (entry == Laws().end()) throw std::invalid_argument("no law is called \"" + std::string(name) + "\"");
  return *entry;
}

/// The table of laws, for the readers in experiment/.
class Catalog final : public LawCatalog {
 public:
  std::span<const std::string_view> names() const override { return LawNames(); }
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

const LawEntry& EntryOf(const LawConfig& law) { return Entry(law.name); }

std::vector<const LawEntry*> LawsIn(const Experiment& experiment) {
  std::vector<const LawEntry*> laws;
  for (const AgentConfig& agent : experiment.agents) {
    const LawEntry* law = &EntryOf(agent.law);
    if (std::ranges::find(laws, law) == laws.end()) laws.push_back(law);
  }
  return laws;
}

namespace {

/// Whether agents fly a law that `is` true of, at the start or in a later phase.
bool EverFlies(const Experiment& experiment, bool (*is)(const LawEntry& law)) {
  const auto is_name = [&](std::string_view name) {
    return std::ranges::any_of(Laws(), [&](const LawEntry& law) { return law.name == name && is(law); });
  };
  const auto begins_one = [&](const Event& event) {
    const auto* name = event.law && event.law->contains("name") ? &event.law->at("name").data : nullptr;
    return name != nullptr && std::holds_alternative<std::string>(*name) && is_name(std::get<std::string>(*name));
  };
  return std::ranges::any_of(LawsIn(experiment), [&](const LawEntry* law) { return is(*law); }) ||
         std::ranges::any_of(experiment.events, begins_one);
}

}  // namespace

bool FliesCodeOfUsers(const Experiment& experiment) {
  return EverFlies(experiment, [](const LawEntry& law) { return law.is_of_user; });
}

std::vector<std::string> UnreadParams(const Experiment& experiment) {
  std::vector<std::string> warnings;
  for (const AgentConfig& agent : experiment.agents) {
    const LawEntry& law = EntryOf(agent.law);
    if (law.unread == nullptr) continue;
    for (std::string& warning : law.unread(agent.law))
      if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(std::move(warning));
  }
  return warnings;
}

std::vector<Perceived> PerceivedIn(const Experiment& experiment) {
  std::vector<Perceived> all;
  for (const AgentConfig& agent : experiment.agents) {
    const LawEntry& law = EntryOf(agent.law);
    if (law.observation == nullptr) continue;
    const ObservationLayout& layout = law.observation(agent.law);
    auto found = std::ranges::find(all, layout, &Perceived::layout);
    if (found == all.end()) found = all.insert(all.end(), {layout, {}});
    found->ids.push_back(agent.id);
  }
  return all;
}

bool EverLeavesOut(const Experiment& experiment) {
  return EverFlies(experiment, [](const LawEntry& law) { return law.left_out != nullptr; });
}

std::vector<std::string_view> DetailsOf(const LawEntry& law) {
  std::vector<std::string_view> paragraphs;
  for (std::string_view rest = law.details; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    paragraphs.push_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return paragraphs;
}

std::vector<std::string> FormulasOf(const LawEntry& law) {
  constexpr std::string_view kBetween = "\\\\\n";
  std::vector<std::string> formulas;
  for (std::string_view rest = law.tex; !rest.empty();) {
    const std::size_t end = std::min(rest.find(kBetween), rest.size());
    std::string_view formula = rest.substr(0, end);
    while (formula.ends_with(' ')) formula.remove_suffix(1);
    formulas.emplace_back(formula);
    rest.remove_prefix(std::min(end + kBetween.size(), rest.size()));
  }
  return formulas;
}

std::vector<int> AgentsWith(const LawEntry& law, const Experiment& experiment) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents)
    if (agent.law.name == law.name) ids.push_back(agent.id);
  return ids;
}

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
  return entry.waypoints_W != nullptr && flies ? entry.waypoints_W(agent) : std::span<const Eigen::Vector3d>();
}

std::span<const int> HullOf(const LawConfig& law) {
  const auto of = EntryOf(law).drawing.hull.of;
  return of != nullptr ? of(law) : std::span<const int>();
}

std::span<const Eigen::Vector2d> RegionOf(const LawConfig& law) {
  const auto of = EntryOf(law).drawing.cells.of;
  return of != nullptr ? of(law) : std::span<const Eigen::Vector2d>();
}

std::optional<LinearForm> LinearFormOf(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.linear != nullptr ? std::optional(entry.linear(law)) : std::nullopt;
}

std::optional<std::size_t> LiarsLeftOutBy(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.liars_left_out != nullptr ? std::optional(entry.liars_left_out(law)) : std::nullopt;
}

std::optional<PursuitForm> PursuitFormOf(const LawConfig& law) {
  const LawEntry& entry = EntryOf(law);
  return entry.pursuit != nullptr ? std::optional(entry.pursuit(law)) : std::nullopt;
}

std::unique_ptr<Law> MakeLaw(const Experiment& experiment, int id) {
  const LawEntry& entry = EntryOf(experiment.agent(id).law);
  if (entry.is_of_user && experiment.user_code == UserCode::kNeverRuns)
    throw std::logic_error("the law of agent " + std::to_string(id) + " is of a user, and is not to be run");
  return entry.make(experiment, id);
}

const LawCatalog& LawTable() {
  static const Catalog table;
  return table;
}

Experiment LoadExperiment(Section document, const std::string& default_name, bool checked, UserCode user_code) {
  return ReadExperiment(std::move(document), LawTable(), default_name, checked, user_code);
}

Experiment LoadExperiment(const std::string& text, const std::string& path, std::span<const Override> overrides,
                          UserCode user_code) {
  const auto load = [&](std::span<const Override> with) {
    return LoadExperiment(Section::FromText(text, path, with), StemOfInput(path), /*checked=*/false, user_code);
  };
  const auto mistakes_with = [&](std::span<const Override> with) -> std::vector<std::string> {
    try {
      load(with);
      return {};
    } catch (const ConfigError& error) {
      return error.mistakes();
    }
  };
  try {
    return load(overrides);
  } catch (const ConfigError& error) {
    throw ConfigError(BlameOverrides(error.mistakes(), path, overrides, mistakes_with));
  }
}

}  // namespace mascot
