#include "orchestrator/fmu/team_variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/state_numbers.h"
#include "experiment/toml/key.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/live/shown/shown_keys.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;
using Causality = FmuVariable::Causality;
using Role = FmuVariable::Role;

/// Collects the variables of a team.
class Collector {
 public:
  explicit Collector(FmuTeam& team) : team_(team) {}

  void Add(FmuVariable variable) { team_.variables.push_back(std::move(variable)); }
  void AddParameter(const char* name, Role role, FmuVariable::Value start, const char* description,
                    const char* unit = "") {
    Add({.name = name,
         .description = description,
         .unit = unit,
         .causality = Causality::kParameter,
         .start = std::move(start),
         .role = role});
  }
  void AddOutput(std::string name, Role role, FmuVariable::Value type, std::string description, int agent = 0,
                 std::size_t index = 0, std::string unit = "") {
    Add({.name = std::move(name),
         .description = std::move(description),
         .unit = std::move(unit),
         .causality = Causality::kOutput,
         .start = std::move(type),
         .role = role,
         .agent = agent,
         .index = index});
  }

  /// The variables of a live key, if its value can be given by variables.
  void AddKey(const ShownKey& key) {
    const Json value = JsonOrNull<Json>(key.value);
    if (!IsOfVariables(value, key.row) || Count(value) == 0) return;
    std::string pattern;
    AddValue(key, value, {}, pattern);
    team_.keys.push_back({key.name, std::move(pattern)});
  }

 private:
  /// Numbers, booleans, one of some names, and lists of those: what a client of a server may set.
  static bool IsOfVariables(const Json& value, const Key& row) {
    if (value.is_array()) return std::ranges::all_of(value, [&](const Json& item) { return IsOfVariables(item, row); });
    return value.is_number() || value.is_boolean() || (value.is_string() && row.kind == ValueKind::kOneOf);
  }
  static std::size_t Count(const Json& value) {
    if (!value.is_array()) return 1;
    std::size_t count = 0;
    for (const Json& item : value) count += Count(item);
    return count;
  }
  static FmuVariable::Value StartOf(const Json& value, const Key& row) {
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_string()) return value.get<std::string>();
    if (row.kind == ValueKind::kInteger) return value.get<std::int64_t>();
    return value.get<double>();
  }

  void AddValue(const ShownKey& key, const Json& value, const std::string& place, std::string& pattern) {
    if (value.is_array()) {
      std::size_t number = 0;
      pattern += '[';
      for (const Json& item : value) {
        if (number++ > 0) pattern += ',';
        AddValue(key, item, place + (place.empty() ? "" : ",") + std::to_string(number), pattern);
      }
      pattern += ']';
      return;
    }
    pattern += '%';
    const std::string name = key.name + (place.empty() ? "" : '[' + place + ']');
    names_.push_back(FmuNameOf(name, names_));
    FmuVariable variable{.name = names_.back(),
                         .description = std::string(key.row.meaning),
                         .causality = Causality::kParameter,
                         .tunable = true,
                         .start = StartOf(value, key.row),
                         .role = Role::kKey,
                         .index = team_.keys.size()};
    if (const auto* number = std::get_if<double>(&variable.start)) {
      const Range& range = key.row.range;
      variable.unit = UnitOf(key.row);
      if (range.min < range.max && range.min <= *number && *number <= range.max)
        variable.range = {range.min, range.max};
    }
    Add(std::move(variable));
  }

  FmuTeam& team_;
  std::vector<std::string> names_;  // of keys so far
};

void AddInputs(Collector& all, const TeamService& service, const Json& ports) {
  std::size_t index = 0;
  for (std::size_t k = 0; k < ports.size(); ++k) {
    const TeamService::Port& port = service.ports()[k];
    const auto wants = ports[k]["wants"].get<std::string>();
    const auto unit = ports[k]["unit"].get<std::string>();
    for (std::size_t n = 0; n < port.numbers; ++n) {
      const bool is_wanted = n < 3;
      all.Add({.name = is_wanted ? fmt::format("agent[{}].wanted_{}[{}]", port.agent, wants, n + 1)
                                 : fmt::format("agent[{}].message[{}]", port.agent, n - 2),
               .description = is_wanted ? "wanted " + wants + " in W" : "a number of the message that the agent sends",
               .unit = is_wanted ? unit : std::string(),
               .causality = Causality::kInput,
               .start = 0.0,
               .role = Role::kAction,
               .agent = port.agent - 1,
               .index = index++});
    }
  }
}

void AddAgent(Collector& all, int id, int agents) {
  const std::string agent = fmt::format("agent[{}].", id);
  for (const StatePart& part : kStateParts)
    for (std::size_t n = 0; n < part.size; ++n)
      all.AddOutput(fmt::format("{}{}[{}]", agent, part.name, n + 1), Role::kState, 0.0, part.meaning, id - 1,
                    part.begin + n, part.unit);
  all.AddOutput(agent + "lost", Role::kLost, false, "whether the agent is lost", id - 1);
  all.AddOutput(agent + "heard_count", Role::kCount, std::int64_t{0}, "from how many agents it has heard so far",
                id - 1);
  if (agents > kMostHeardAgents) return;
  for (int other = 1; other <= agents; ++other)
    all.AddOutput(fmt::format("{}heard[{}]", agent, other), Role::kHeard, false,
                  fmt::format("whether it has heard from agent {} so far", other), id - 1,
                  static_cast<std::size_t>(other - 1));
}

/// A name in C that is like a name of a run.
std::string IdentifierOf(const std::string& name) {
  std::string identifier;
  for (const char c : name.substr(0, kLongestFmuName)) {
    const bool is_usual = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    identifier += is_usual ? c : '_';
  }
  const bool is_name = !identifier.empty() && !(identifier.front() >= '0' && identifier.front() <= '9');
  return is_name ? identifier : "team_" + identifier;
}

}  // namespace

std::string FmuNameOf(const std::string& name, const std::vector<std::string>& taken) {
  constexpr std::string_view kUsual = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.[],";
  std::string usual = name;
  for (char& c : usual)
    if (kUsual.find(c) == kUsual.npos) c = '_';
  std::string unique = usual.size() > kLongestFmuName ? "" : usual;
  for (int number = 2; unique.empty() || std::ranges::find(taken, unique) != taken.end(); ++number) {
    // What is in brackets stays behind the name of the key.
    const std::size_t bracket = std::min(usual.find('['), usual.size());
    const std::string end = '_' + std::to_string(number) + usual.substr(bracket);
    unique = usual.substr(0, std::min(bracket, kLongestFmuName - std::min(end.size(), kLongestFmuName))) + end;
  }
  return unique;
}

FmuTeam FmuTeamOf(TeamService& service, std::vector<int> ports) {
  const Experiment& experiment = service.team().experiment();
  const Json hello = service.Answer({{"request", "hello"}, {"protocol", kServeProtocol}});
  FmuTeam team{.name = experiment.run.name,
               .identifier = IdentifierOf(experiment.run.name),
               .agents = experiment.size(),
               .rate_hz = experiment.control.rate_hz,
               .duration_s = experiment.run.duration_s,
               .ports = std::move(ports),
               .action_numbers = service.action_numbers()};
  for (const char* field : {"name", "agents", "rate_hz", "ports"})
    team.hello.emplace_back(field, CompactJson(hello[field]));

  Collector all(team);
  all.Add({.name = "time",
           .description = "simulated time",
           .unit = "s",
           .causality = Causality::kIndependent,
           .start = 0.0,
           .role = Role::kTime});
  all.AddParameter("address", Role::kAddress, std::string(),
                   "ADDRESS:PORT of an `orchestrator serve` that flies the team; empty: the FMU starts one (on Linux)");
  all.AddParameter("orchestrator", Role::kProgram, std::string("orchestrator"),
                   "the program that the FMU starts; a name without / is looked for in PATH");
  all.AddParameter("engine", Role::kEngine, std::string("inprocess"),
                   "how the program that the FMU starts flies the team: inprocess or dds");
  all.AddParameter("timeout_s", Role::kTimeout, 60.0, "how long an answer of the team may take", "s");
  all.AddParameter("seed", Role::kSeed, static_cast<std::int64_t>(experiment.run.seed), "run.seed of the episode");
  for (const ShownKey& key : ShownKeysOf(experiment)) all.AddKey(key);
  AddInputs(all, service, hello["ports"]);
  all.AddOutput("tick", Role::kTick, std::int64_t{0}, "which tick the outputs are of");
  all.AddOutput("over", Role::kEnd, false, "whether the episode is over, so that no step is possible");
  std::size_t index = 0;
  for (const TeamService::Figure& figure : TeamService::FigureTable())
    all.AddOutput(figure.name, Role::kFigure, 0.0, figure.description, 0, index++, figure.unit);
  for (int id = 1; id <= team.agents; ++id) AddAgent(all, id, team.agents);
  return team;
}

}  // namespace mascot
