#include "agent/laws/flocking/flock_meter.h"

#include <algorithm>
#include <cmath>

#include "agent/laws/flocking/flock_energy.h"
#include "agent/laws/laws.h"
#include "agent/laws/parts/rounding.h"

namespace mascot {
std::vector<PredictedFigure> PredictFlock(const Experiment& experiment) {
  const auto& params = ParamsOf<FlockParams>(experiment.law);
  const double h = experiment.period_s();
  std::vector<Motion> start(experiment.agents.size());
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents) {
    ids.push_back(agent.id);
    start[ids.size() - 1].p_WB = agent.p_W;
    start[ids.size() - 1].v_WB = agent.v_W;
  }
  FlockCentre centre = CentreOf(start, ids, experiment.law.axes);
  // About the centre no agent is faster than all the energy would make it.
  const double about_m_per_s = std::sqrt(2 * FlockEnergy(params, experiment.graph, start, ids, experiment.law.axes));
  double fastest_m_per_s = centre.v_W.norm();
  const Eigen::Vector3d v_r_W = Along(experiment.law.axes, params.target_velocity_W);
  Eigen::Vector3d off_W = centre.p_W - Along(experiment.law.axes, params.target_W);
  double squares = 0;
  for (std::int64_t tick = 0; tick < experiment.ticks(); ++tick) {
    squares += off_W.squaredNorm();
    const Eigen::Vector3d a_W = -params.c1_gamma * off_W - params.c2_gamma * (centre.v_W - v_r_W);
    off_W += h * (centre.v_W - v_r_W) + h * h / 2 * a_W;
    centre.v_W += h * a_W;
    fastest_m_per_s = std::max(fastest_m_per_s, centre.v_W.norm());
  }
  const double rms_m = std::sqrt((squares + off_W.squaredNorm()) / static_cast<double>(experiment.ticks() + 1));
  const double speed_m_per_s = about_m_per_s + fastest_m_per_s + v_r_W.norm();
  const double largest_m =
      LargestStart_m(experiment) + params.target_W.norm() + speed_m_per_s * experiment.run.duration_s;
  PredictedFigure growth{.bound = Bound::kAtMost};
  if (const auto share = FlockEnergyGrowth(experiment, params)) growth.values = {*share};
  growth.why = !growth.values.empty()
                   ? WhyRangeCuts(experiment, params)
                   : "the control period is too long for the gains and for how many agents may be near";
  if (!growth.why.empty()) growth.values.clear();
  return {{},
          {},
          {},
          {},
          {.values = {rms_m}, .magnitude = largest_m},
          {.values = {off_W.norm()}, .magnitude = largest_m},
          {.values = {(centre.v_W - v_r_W).norm()}, .magnitude = speed_m_per_s},
          growth};
}

FlockMeter::FlockMeter(const Experiment& experiment, std::span<const int> ids)
    : experiment_(&experiment), ids_(ids.begin(), ids.end()) {}

const FlockParams& FlockMeter::params() const { return ParamsOf<FlockParams>(experiment_->agent(ids_.front()).law); }

void FlockMeter::Adopt(const Experiment& now) {
  experiment_ = &now;
  energy_.reset();  // another law has another energy
}

void FlockMeter::Add(const TeamRow& row) {
  newest_.assign(row.motions.begin(), row.motions.end());
  const FlockCentre centre = CentreOf(newest_, ids_, axes());
  off_W_ = centre.p_W - Along(axes(), params().Target_W(experiment_->time_s(row.tick)));
  speed_off_W_ = centre.v_W - Along(axes(), params().target_velocity_W);
  squares_ += off_W_.squaredNorm();
  ticks_ += 1;
  ForEachPair(experiment_->graph, newest_, ids_, axes(), [&](int /*i*/, const Graph::Neighbour& /*j*/, double l) {
    least_distance_m_ = std::min(l, least_distance_m_.value_or(l));
  });
  const double energy = FlockEnergy(params(), experiment_->graph, newest_, ids_, axes());
  if (!first_energy_) first_energy_ = energy;
  if (energy_) growth_ = std::max(energy - *energy_, growth_.value_or(energy - *energy_));
  energy_ = energy;
}

double FlockMeter::Groups() const {
  std::vector<std::vector<Graph::Neighbour>> near(newest_.size());
  ForEachPair(experiment_->graph, newest_, ids_, axes(), [&](int i, const Graph::Neighbour& j, double l) {
    if (l >= params().pair.range_m()) return;
    near[static_cast<std::size_t>(i - 1)].push_back({j.id, 1});
    near[static_cast<std::size_t>(j.id - 1)].push_back({i, 1});
  });
  for (auto& one : near) std::ranges::sort(one, {}, &Graph::Neighbour::id);
  return static_cast<double>(Graph(std::move(near)).Components().size() - (newest_.size() - ids_.size()));
}

double FlockMeter::VelocityOff(const FlockCentre& centre) const {
  double off = 0;
  for (const int id : ids_)
    off = std::max(off, (Along(axes(), newest_[static_cast<std::size_t>(id - 1)].v_WB) - centre.v_W).norm());
  return off;
}

std::optional<double> FlockMeter::Curve() const {
  return newest_.empty() ? std::nullopt : std::optional(VelocityOff(CentreOf(newest_, ids_, axes())));
}

std::vector<FigureValues> FlockMeter::Figures() const {
  if (newest_.empty()) return std::vector<FigureValues>(std::size(kFlockFigures), FigureValues{std::nullopt});
  const FlockCentre centre = CentreOf(newest_, ids_, axes());
  Eigen::Vector3d directions = Eigen::Vector3d::Zero();
  for (const int id : ids_)
    directions +=
        Along(axes(), newest_[static_cast<std::size_t>(id - 1)].v_WB).normalized() / static_cast<double>(ids_.size());
  const auto share = growth_ && *first_energy_ > 0 ? std::optional(*growth_ / *first_energy_) : std::nullopt;
  return {{directions.norm()},
          {VelocityOff(centre)},
          {least_distance_m_},
          {Groups()},
          {std::sqrt(squares_ / ticks_)},
          {off_W_.norm()},
          {speed_off_W_.norm()},
          {share}};
}

}  // namespace mascot
