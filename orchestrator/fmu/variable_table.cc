#include "orchestrator/fmu/variable_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <bit>

namespace mascot {
namespace {

/// The names of roles, in the order of FmuVariable::Role; team_fmu.c has the same.
constexpr std::array kRoleNames = {"time", "address", "orchestrator", "engine", "timeout", "seed",  "key",  "action",
                                   "tick", "end",     "figure",       "state",  "lost",    "count", "heard"};

/// A double by the digits of its bits, so that no locale has a say when they are read.
std::string Bits(double number) { return fmt::format("{:016x}", std::bit_cast<std::uint64_t>(number)); }

/// The letter of a variable's type: of a double r, an integer i, a boolean b, a text s. And its start.
std::string TypeOf(const FmuVariable::Value& start) { return std::string(1, "ribs"[start.index()]); }
std::string TextOf(double number) { return Bits(number); }
std::string TextOf(std::int64_t number) { return std::to_string(number); }
std::string TextOf(bool is_true) { return is_true ? "1" : "0"; }
std::string TextOf(const std::string& text) { return text; }

}  // namespace

std::string VariableTable(const FmuTeam& team, const std::string& token, const std::string& program) {
  std::string table = fmt::format("mascot fmu 1\ntoken {}\nprogram {}\nports [{}]\nrate_hz {}\nagents {}\n", token,
                                  program, fmt::join(team.ports, ","), Bits(team.rate_hz), team.agents);
  table += fmt::format("figures {}\nactions {}\n", TeamService::FigureTable().size(), team.action_numbers);
  for (const auto& [field, value] : team.hello) table += fmt::format("hello {} {}\n", field, value);
  std::size_t next_key = 0;
  for (const FmuVariable& variable : team.variables) {
    if (variable.role == FmuVariable::Role::kKey && variable.index == next_key) {
      const FmuKey& key = team.keys[next_key++];
      table += fmt::format("key {} {}\n", key.path, key.value);
    }
    const char* const role = kRoleNames.at(static_cast<std::size_t>(variable.role));
    const std::string start = std::visit([](const auto& value) { return TextOf(value); }, variable.start);
    table += fmt::format("variable {} {} {} {} {} {}\n", variable.name, TypeOf(variable.start), role, variable.agent,
                         variable.index, start);
  }
  return table + "end\n";
}

}  // namespace mascot
