#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string_view>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The built-in airframe `name`.
inline Airframe Built(std::string_view name) { return *std::ranges::find(Airframes(), name, &Airframe::name); }

/// An experiment with agents of one model at these positions; everything else has its default.
inline Experiment Bodies(std::string_view model, const std::vector<Eigen::Vector3d>& places,
                         const Airframe& airframe = Built("mascot")) {
  Experiment experiment;
  for (const Eigen::Vector3d& p_W : places) {
    AgentConfig agent;
    agent.id = experiment.size() + 1;
    agent.model = model;
    agent.airframe = airframe;
    agent.p_W = p_W;
    experiment.agents.push_back(agent);
  }
  return experiment;
}

/// `airframe` without drag, so that closed forms hold.
inline Airframe WithoutDrag(Airframe airframe = Built("mascot")) {
  airframe.linear_drag_kg_per_s = 0;
  return airframe;
}

}  // namespace mascot
