#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "orchestrator/team/row.h"

namespace mascot {

/// One of the arrays that a run grows by a row per tick. What each holds: docs/recording.md.
struct StateArray {
  std::string_view name;
  std::string_view components;  ///< of each agent, a letter each; empty: one number a row, whoever flies
  bool of_command = false;      ///< from what the agents commanded, not from how they moved

  /// Numbers in a row.
  std::size_t row_values(std::size_t agents) const { return components.empty() ? 1 : agents * components.size(); }
};

/// All of them, in the order of states.npz.
inline constexpr std::array<StateArray, 7> kStateArrays = {{
    {"t", ""},
    {"position", "xyz"},
    {"velocity", "xyz"},
    {"orientation", "wxyz"},
    {"angular_velocity", "xyz"},
    {"acceleration_command", "xyz", true},
    {"actuator", "1234", true},
}};

/// One tick's row of each of those arrays.
class StateRow {
 public:
  explicit StateRow(int agents);

  void Set(double t_s, const DecodedRow& decoded);
  /// Of kStateArrays[array]: agent after agent, all components of each.
  std::span<const double> Values(std::size_t array) const { return values_[array]; }

 private:
  std::array<std::vector<double>, kStateArrays.size()> values_;
};

}  // namespace mascot
