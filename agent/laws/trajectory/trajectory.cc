// Tracking of a trajectory r(t) by double integrators, alone or in formation: feed-forward of its acceleration, and
// feedback of the errors of position and velocity; Mellinger & Kumar (2011); Lee, Leok & McClamroch (2010):
//   a_i = a_r + p_gain (r + d_i - p_i) + d_gain (v_r - v_i),  d_i the place of the agent
// A command is held for a tick h: a_r is that of its middle, t + h / 2. The error e then obeys e'' + d_gain e' + p_gain
// e = 0. Without feed-forward each oscillation e^(jwt) of r comes out as (p + j d w) / (p - w^2 + j d w) of itself (p,
// d the gains): larger or smaller, and late. Theory has both for the sampled loop, after the start has been forgotten.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/places.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/trajectory/tracking.h"

namespace mascot {
namespace {

constexpr std::array kTrackingGains = {
    key::Number("p_gain", {0, 1000}, "pull towards the trajectory").Default("1.0").Unit("1/s^2").Live(),
    key::Number("d_gain", {0, 1000}, "pull towards its velocity").Default("2.0").Unit("1/s").Live(),
    key::Boolean("feed_forward", "whether its acceleration is fed forward").Default("true").Live(),
};
constexpr auto kTrajectoryParameters = Joined(kPathKeys, Joined(kTrackingGains, kPlaceKeys));

struct TrajectoryParams final : LawParams {
  ReferencePath path;
  std::vector<Eigen::Vector3d> d_W;  ///< by id - 1
  double p = 0;                      ///< 1/s^2
  double d = 0;                      ///< 1/s
  bool feed_forward = true;

  const Eigen::Vector3d& place_W(int id) const { return d_W[static_cast<std::size_t>(id - 1)]; }
};

class Trajectory final : public Law {
 public:
  Trajectory(const AgentConfig& agent, double period_s) : id_(agent.id), half_tick_s_(period_s / 2) { Adopt(agent); }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<TrajectoryParams>(agent.law); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    const PathPoint r = params_->path.At(t_s);
    Eigen::Vector3d a_W = Eigen::Vector3d::Zero();
    if (params_->feed_forward) a_W = params_->path.At(t_s + half_tick_s_).a_W;
    return a_W + params_->p * (r.p_W + params_->place_W(id_) - self.p_WB) + params_->d * (r.v_W - self.v_WB);
  }

 private:
  int id_;
  double half_tick_s_;
  const TrajectoryParams* params_ = nullptr;  // the experiment owns them
};

std::shared_ptr<const LawParams> ReadTrajectory(const Experiment& experiment, const LawConfig& /*law*/,
                                                Section& section) {
  auto params = std::make_shared<TrajectoryParams>();
  params->path = ReadPath(section);
  const bool is_alone = experiment.size() == 1 && !section.Has("offsets_m") && !section.Has("shape");
  params->d_W =
      is_alone ? std::vector<Eigen::Vector3d>{Eigen::Vector3d::Zero()} : ReadPlaces(section, experiment.size());
  params->p = section.Number("p_gain");
  params->d = section.Number("d_gain");
  params->feed_forward = section.Boolean("feed_forward");
  return params;
}

std::span<const Eigen::Vector3d> PlacesOfTrajectory_W(const LawConfig& law) {
  return ParamsOf<TrajectoryParams>(law).d_W;
}

class TrajectoryMeter final : public LawMeter {
 public:
  TrajectoryMeter(const Experiment& experiment, std::span<const int> ids)
      : experiment_(&experiment), ids_(ids.begin(), ids.end()) {}
  void Adopt(const Experiment& now) override { experiment_ = &now; }
  void Add(const TeamRow& row) override {
    const double t_s = experiment_->time_s(row.tick), end_s = experiment_->time_s(experiment_->ticks());
    error_m_.reset();
    for (const int id : ids_) {
      const AgentConfig& agent = experiment_->agent(id);
      const auto& params = ParamsOf<TrajectoryParams>(agent.law);
      if (t_s < agent.start_s || t_s >= agent.stop_s) continue;
      const Eigen::Vector3d q_W = row.motions[static_cast<std::size_t>(id - 1)].p_WB - params.place_W(id);
      const double own_m = Along(agent.law.axes, params.path.At(t_s).p_W - q_W).norm();
      error_m_ = std::max(own_m, error_m_.value_or(own_m));
      if (t_s <= end_s - params.path.period_s) continue;
      meter_.Add(params.path.At(t_s), q_W, agent.law.axes);
    }
  }
  std::vector<FigureValues> Figures() const override { return meter_.Figures().List(); }
  std::optional<double> Curve() const override { return error_m_; }

 private:
  const Experiment* experiment_;
  std::vector<int> ids_;
  std::optional<double> error_m_;  // the largest in the newest row
  TrackingMeter meter_;
};

/// How far from the long run an agent may still be when the last period begins (m).
double RestOfStart_m(const Experiment& experiment, const TrajectoryParams& params, double radius, double steady_m) {
  const PathPoint r = params.path.At(0);
  double start_m = 0;
  for (const AgentConfig& agent : experiment.agents)
    start_m = std::max(start_m, (r.p_W + params.place_W(agent.id) - agent.p_W).norm() +
                                    (r.v_W - agent.v_W).norm() / std::sqrt(params.p));
  const double ticks = static_cast<double>(experiment.ticks()) - params.path.period_s / experiment.period_s();
  return (start_m + steady_m) * std::pow(radius, ticks);
}

LawTheory PredictTrajectory(const Experiment& experiment) {
  const auto& params = ParamsOf<TrajectoryParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kAcceleration); !why.empty()) return {.silent = std::move(why)};
  if (params.path.samples) return {.silent = "the closed form is of circles and figures of eight"};
  const SampledPd loop{.p = params.p, .d = params.d, .h = experiment.period_s()};
  if (loop.Radius() >= 1) return {.silent = "the loop of law.p_gain and law.d_gain does not decay"};
  double limit_m_per_s2 = experiment.agents.front().control.max_acceleration_m_per_s2;
  for (const AgentConfig& agent : experiment.agents)
    limit_m_per_s2 = std::min(limit_m_per_s2, agent.control.max_acceleration_m_per_s2);
  const auto steady = SteadyTracking(params.path, loop, params.feed_forward, limit_m_per_s2);
  if (!steady) return {.silent = "the limit of the acceleration cuts what the trajectory takes"};
  if (RestOfStart_m(experiment, params, loop.Radius(), *steady->rms_m) > 1e-3)
    return {.silent = "the run ends before the start has been forgotten for a period"};
  return {.figures = Equal(steady->List())};
}

}  // namespace

LawEntry TrajectoryLaw() {
  return {.name = "trajectory",
          .summary = "agents follow a circle, a figure eight or samples over time, alone or in formation",
          .equation = "a_i = a_r + p_gain (r + d_i - p_i) + d_gain (v_r - v_i);  a_r only with feed_forward",
          .tex = R"(a_i = a_r + k_p (r + d_i - p_i) + k_d (v_r - v_i) \\
\text{without feed-forward, } a_r = 0)",
          .symbols = {{"p_gain", "k_p"}, {"d_gain", "k_d"}, {"offsets_m", "d_i"}},
          .graph = "none: agents do not listen",
          .details =
              "r and v_r are those of the time t of the tick; a_r is that of t + h / 2, the middle of the tick "
              "over which it is held.\n"
              "A lone agent without offsets_m and shape has d_i = 0. Samples are joined by a cubic spline; the "
              "reference rests at the first one before its time, and at the last one after it.",
          .theory =
              "with feed-forward the error goes to 0: e'' + d_gain e' + p_gain e = 0; without, an oscillation of r at "
              "omega comes out times (p_gain + j d_gain omega) / (p_gain - omega^2 + j d_gain omega), late",
          .source =
              "Mellinger & Kumar, Minimum snap trajectory generation and control for quadrotors, ICRA 2011; Lee, Leok "
              "& McClamroch, Geometric tracking control of a quadrotor UAV on SE(3), CDC 2010",
          .parameters = kTrajectoryParameters,
          .figures = kTrackingFigures,
          .curve = LawCurve{.name = "tracking error",
                            .unit = "m",
                            .meaning = "of the agent that is farthest from its place on the path"},
          .axes = Axes::kXyz,
          .drawing = {},
          .read = ReadTrajectory,
          .make = MakeWithPeriod<Trajectory>,
          .places_W = PlacesOfTrajectory_W,
          .predict = PredictTrajectory,
          .meter = MeterOf<TrajectoryMeter>};
}

}  // namespace mascot
