#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/laws/flocking/flocking.h"
#include "agent/laws/law_figures.h"

namespace mascot {

// What the law flocking measures and predicts. Neighbours: agents that hear each other and are within law's range.

inline constexpr std::string_view kEndUnknown = "where the energy has minima is not known";
inline constexpr LawFigure kFlockFigures[] = {
    {.name = "order",
     .meaning = "length of the mean of the agents' directions of flight at the end: 1 if all are one",
     .unpredicted = kEndUnknown},
    {.name = "velocity_off_m_per_s",
     .meaning = "the most that a velocity is off the mean at the end",
     .unpredicted = kEndUnknown},
    {.name = "least_distance_m",
     .meaning = "the smallest distance, along the axes of the law, of agents that hear "
                "each other",
     .unpredicted = kEndUnknown},
    {.name = "groups",
     .meaning = "into how many parts the flock falls at the end, by which agents are within range of each other",
     .unpredicted = kEndUnknown},
    {.name = "centre_rms_m", .meaning = "rms distance of the centre of mass to the gamma agent"},
    {.name = "centre_off_m", .meaning = "the same distance at the end"},
    {.name = "centre_off_m_per_s", .meaning = "how far its velocity is off that of the gamma agent at the end"},
    {.name = "energy_growth_share",
     .meaning = "the most by which the structural energy grew in a tick, as a share of that at the start"},
};

/// In the order of kFlockFigures, for double integrators whose law knows the true motions, on an undirected graph. The
/// centre of mass is exact: it moves by itself. The energy grows by no more than holding a command for a tick may cost;
/// theory does not say how much that is if the period is too long for the gains.
std::vector<PredictedFigure> PredictFlock(const Experiment& experiment);

class FlockMeter final : public LawMeter {
 public:
  FlockMeter(const Experiment& experiment, std::span<const int> ids);
  void Adopt(const Experiment& now) override;
  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override;
  std::optional<double> Curve() const override;

 private:
  const FlockParams& params() const;
  Axes axes() const { return experiment_->agent(ids_.front()).law.axes; }
  double Groups() const;
  /// The most that a velocity is off that of the centre (m/s).
  double VelocityOff(const FlockCentre& centre) const;

  const Experiment* experiment_;
  std::vector<int> ids_;
  std::vector<Motion> newest_;  // of all agents, by id - 1
  std::optional<double> energy_, first_energy_, growth_, least_distance_m_;
  Eigen::Vector3d off_W_ = Eigen::Vector3d::Zero(), speed_off_W_ = Eigen::Vector3d::Zero();  // of the centre, newest
  double squares_ = 0, ticks_ = 0;
};

}  // namespace mascot
