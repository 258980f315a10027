#include "agent/laws/parts/inputs.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace mascot {
namespace {

std::vector<double> NumbersOfAgents(const Experiment& experiment, Section& law, std::string_view key) {
  std::vector<double> numbers = law.Numbers(key);
  const std::size_t count = experiment.agents.size();
  if (law.Has(key) && !law.Wrong(key) && count > 0 && numbers.size() != count)
    law.Fail(key, fmt::format("expected {} numbers, one per agent, got a list of {}", count, numbers.size()));
  numbers.resize(count);
  return numbers;
}

}  // namespace

Eigen::Vector3d Input::At(double t_s) const {
  return constant_m + ramp_m_per_s * t_s +
         amplitude_m * std::sin(2 * std::numbers::pi * frequency_hz * t_s + phase_rad);
}

std::vector<Eigen::Vector3d> PointsOfAgents(const Experiment& experiment, Section& law, std::string_view key,
                                            std::vector<Eigen::Vector3d> otherwise) {
  if (!law.Has(key)) return otherwise;
  std::vector<Eigen::Vector3d> points = law.Points(key);
  const std::size_t count = experiment.agents.size();
  if (!law.Wrong(key) && count > 0 && points.size() != count)
    law.Fail(key, fmt::format("expected {} points, one per agent, got a list of {}", count, points.size()));
  points.resize(count, Eigen::Vector3d::Zero());
  return points;
}

std::vector<Input> ReadInputs(const Experiment& experiment, Section& law) {
  const std::vector<Eigen::Vector3d> zero(experiment.agents.size(), Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> starts;
  for (const AgentConfig& agent : experiment.agents) starts.push_back(agent.p_W);
  const auto constants = PointsOfAgents(experiment, law, "inputs_m", std::move(starts));
  const auto ramps = PointsOfAgents(experiment, law, "ramps_m_per_s", zero);
  const auto amplitudes = PointsOfAgents(experiment, law, "amplitudes_m", zero);
  const auto frequencies = NumbersOfAgents(experiment, law, "frequencies_hz");
  const auto phases = NumbersOfAgents(experiment, law, "phases_rad");
  std::vector<Input> inputs;
  for (std::size_t i = 0; i < zero.size(); ++i)
    inputs.push_back({constants[i], ramps[i], amplitudes[i], frequencies[i], phases[i]});
  return inputs;
}

}  // namespace mascot
