#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "orchestrator/serving/team_service.h"

namespace mascot {

/// The longest name of a variable: some tools cut off longer ones.
inline constexpr std::size_t kLongestFmuName = 55;
/// Teams of more agents have no variables for each pair of agents.
inline constexpr int kMostHeardAgents = 100;

/// A variable of the FMU of a team.
struct FmuVariable {
  enum class Causality { kIndependent, kParameter, kInput, kOutput };
  /// What team_fmu.c takes it for.
  enum class Role {
    kTime,
    kAddress,
    kProgram,
    kEngine,
    kTimeout,
    kSeed,
    kKey,
    kAction,
    kTick,
    kEnd,
    kFigure,
    kState,
    kLost,
    kCount,
    kHeard
  };
  using Value = std::variant<double, std::int64_t, bool, std::string>;

  std::string name;  ///< unique, at most kLongestFmuName bytes
  std::string description;
  std::string unit = {};  ///< of a double; "": none
  Causality causality = Causality::kOutput;
  bool tunable = false;  ///< a parameter that may change between steps
  Value start = 0.0;     ///< its alternative is the variable's type; outputs are computed
  /// Legal values of a double parameter, both ends included.
  std::optional<std::pair<double, double>> range = {};
  Role role = Role::kTime;
  int agent = 0;          ///< counted from 0
  std::size_t index = 0;  ///< within what the role names
};

/// A live key, whose value some variables are.
struct FmuKey {
  std::string path;   ///< "law.p_gain"
  std::string value;  ///< as JSON, with % for each variable: "[%,%,%]"
};

/// What the FMU of a team has for a tool.
struct FmuTeam {
  std::string name;        ///< run.name
  std::string identifier;  ///< a name in C, of its files
  int agents = 0, rate_hz = 0;
  double duration_s = 0;
  std::vector<int> ports = {};              ///< agents that take actions in the place of their laws
  std::size_t action_numbers = 0;           ///< of all agents that take actions
  std::vector<FmuVariable> variables = {};  ///< the value reference of a variable is its place here; the first is time
  std::vector<FmuKey> keys = {};            ///< in the order of their variables
  std::vector<std::pair<std::string, std::string>> hello = {};  ///< fields of a server's answer, and what they must be
};

/// The variables of a team. `ports`: as given to the TeamService.
FmuTeam FmuTeamOf(TeamService& service, std::vector<int> ports);

/// A name in which characters that structured names of FMI do not have are `_`, and which none of `taken` is: at most
/// kLongestFmuName bytes, with an end such as "_2" where it would be cut to one that is taken.
std::string FmuNameOf(const std::string& name, const std::vector<std::string>& taken);

}  // namespace mascot
