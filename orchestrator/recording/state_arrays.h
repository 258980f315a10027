#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "orchestrator/team/row.h"

namespace mascot {

/// One of the arrays of states.npz, which have one row per tick. docs/recording.md says what each contains.
struct StateArray {
  std::string_view name;
  /// The components for each agent, one letter each; "1": one number for each agent; empty: one number for the row, not
  /// for each agent.
  std::string_view components;
  bool of_command = false;  ///< taken from the commands, not from the states

  bool has_one() const { return components == "1"; }
  /// Number of values in a row.
  std::size_t row_values(std::size_t agents) const { return components.empty() ? 1 : agents * components.size(); }
};

/// All arrays, in the order of states.npz.
inline constexpr std::array<StateArray, 8> kStateArrays = {{
    {"t", ""},
    {"position", "xyz"},
    {"velocity", "xyz"},
    {"orientation", "wxyz"},
    {"angular_velocity", "xyz"},
    {"acceleration_command", "xyz", true},
    {"actuator", "1234", true},
    {"flags", "1", true},
}};

/// One tick's row of every array of kStateArrays.
class StateRow {
 public:
  explicit StateRow(int agents);

  void Set(double t_s, const DecodedRow& decoded);
  /// The row of kStateArrays[array]: agent after agent, all components of each.
  std::span<const double> Values(std::size_t array) const { return values_[array]; }

 private:
  std::array<std::vector<double>, kStateArrays.size()> values_;
};

}  // namespace mascot
