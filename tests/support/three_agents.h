// Agent 1 and its two neighbours, for tests of laws that users write.
#pragma once

#include <string>
#include <vector>

#include "agent/agent.h"
#include "tests/support/load.h"

namespace mascot {

/// Three double integrators; agent 1 hears 2 and 3. `lines`: keys of [law], from line 10 on if `agents` is empty.
inline std::string Three(const std::string& lines, const std::string& agents = "") {
  return "[run]\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\n"
         "position_m = [[0, 0, 1], [1, 0, 2], [0, 2, 3]]\n" +
         agents + "[graph]\nedges = [[1, 2, 0.5], [1, 3]]\n[law]\n" + lines;
}

/// What the error for the experiment `toml` says; empty: it is valid.
inline std::string Refusal(const std::string& toml) {
  try {
    Load(toml);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

/// The samples that agent 1 hears: states of 2 and 3, and a message of 3.
struct Others {
  Motion two, three;
  std::vector<double> said;
  std::vector<Sample> samples() const { return {{&two, {}}, {&three, said}}; }
};

inline Others Standing() {
  Others others;
  others.two.p_WB = {1, 0, 2};
  others.three.p_WB = {0, 2, 3};
  others.three.v_WB = {0.5, 0, 0};
  return others;
}

}  // namespace mascot
