// Runs laws written in Python as that of agent 1 of three agents.
#pragma once

#include <stdexcept>
#include <string>

#include "agent/agent.h"
#include "tests/support/three_agents.h"

namespace mascot {

inline Experiment Custom(const std::string& python, const std::string& lines = "") {
  return Load(Three("name = 'custom'\n" + lines + "python = '''\n" + python + "'''\n"));
}

inline std::string LawRefusal(const std::string& lines) { return Refusal(Three(lines)); }

/// Output of the law of agent 1 at tick 0, in W: acceleration (m/s^2) or velocity (m/s), whichever it wants.
inline Eigen::Vector3d Wants(const std::string& python, const std::string& lines = "") {
  Experiment experiment = Custom(python, lines);
  Agent agent(experiment, 1);
  const Others others = Standing();
  Motion self;
  self.p_WB = {0, 0, 1};
  self.v_WB = {0, 0.25, 0};
  return agent.Want(0, self, others.samples()).a_law_W;
}

/// The error of the law of agent 1 at tick 3; empty: none.
inline std::string Failure(const std::string& python, const std::string& lines = "") {
  Experiment experiment = Custom(python, lines);
  Agent agent(experiment, 1);
  const Others others = Standing();
  try {
    agent.Want(3, Motion{}, others.samples());
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace mascot
