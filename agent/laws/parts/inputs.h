#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

// What each agent knows of the world in average tracking, its input: r_i(t) = input + ramp t + amplitude sin(2 pi f t +
// phase).

inline constexpr Range kInputs_m = {-1e6, 1e6};

inline constexpr auto kInputKeys = std::array{
    key::Points("inputs_m", kInputs_m, "the constant part of each agent's input").Otherwise("where each starts"),
    key::Points("ramps_m_per_s", {-1000, 1000}, "how each input grows").Otherwise("all zero"),
    key::Points("amplitudes_m", kInputs_m, "how far each input swings").Otherwise("all zero"),
    key::Numbers("frequencies_hz", {0, 1000}, "how often each input swings").Otherwise("all zero"),
    key::Numbers("phases_rad", {-10, 10}, "where in its swing each input starts").Otherwise("all zero"),
};

/// The input of one agent.
struct Input {
  Eigen::Vector3d constant_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d ramp_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d amplitude_m = Eigen::Vector3d::Zero();
  double frequency_hz = 0;
  double phase_rad = 0;

  Eigen::Vector3d At(double t_s) const;
};

/// Reads the keys above: one input for each agent, by id - 1.
std::vector<Input> ReadInputs(const Experiment& experiment, Section& law);
/// The points of `key`, one for each agent, or `otherwise` if there is no such key; notes a mistake if there are too
/// many or too few.
std::vector<Eigen::Vector3d> PointsOfAgents(const Experiment& experiment, Section& law, std::string_view key,
                                            std::vector<Eigen::Vector3d> otherwise);

}  // namespace mascot
