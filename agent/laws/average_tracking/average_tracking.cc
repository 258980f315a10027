// Dynamic average consensus: agents follow the average of inputs that change, of which each knows only its own; Kia,
// Van Scoy, Cortes, Freeman, Lynch & Martinez (2019), in discrete time:
//   x_i(k) = r_i(k) + q_i(k),  q_i(k+1) = q_i(k) + h gain sum_j a_ij (x_j(k) - x_i(k)),  q_i(0) = 0
// Agents say their estimates x_i; a message takes one tick, which is the one of this iteration. On an undirected graph
// the q_i sum up to 0: the sum of estimates is that of the inputs at every tick. Each agent flies to its place around
// its estimate:
//   v_i = p_gain (x_i + d_i - p_i) + (x_i(k) - x_i(k-1)) / h
#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/average_tracking/tracking_error.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/inputs.h"
#include "agent/laws/parts/places.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/sampled_modes.h"

namespace mascot {
namespace {

constexpr auto kAverageTrackingParameters = Joined(
    std::array{
        key::Number("gain", Above(0, 1000), "pull of the estimate towards that of each neighbour, times its weight")
            .Default("5.0")
            .Unit("1/s")
            .Live(),
        key::Number("p_gain", {0, 1000}, "pull of the agent towards its place").Default("2.0").Unit("1/s").Live(),
    },
    Joined(kPlaceKeys, kInputKeys));

struct AverageTrackingParams final : LawParams {
  double gain = 0;    ///< 1/s
  double p_gain = 0;  ///< 1/s
  double period_s = 0;
  std::vector<Eigen::Vector3d> d_W;  ///< by id - 1, as the inputs
  std::vector<Input> inputs;
};

class AverageTracking final : public Law {
 public:
  explicit AverageTracking(const AgentConfig& agent) : i_(static_cast<std::size_t>(agent.id - 1)) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<AverageTrackingParams>(agent.law); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    for (const Heard& j : heard)
      if (has_x_ && j.message.size() == 3)  // if this agent has just begun, j has heard nothing of it yet
        q_W_ +=
            params_->period_s * params_->gain * j.weight * (Eigen::Map<const Eigen::Vector3d>(j.message.data()) - x_W_);
    const Eigen::Vector3d x_W = params_->inputs[i_].At(t_s) + q_W_;
    const Eigen::Vector3d way_W = has_x_ ? x_W - x_W_ : Eigen::Vector3d::Zero().eval();
    x_W_ = x_W;
    has_x_ = true;
    return params_->p_gain * (x_W + params_->d_W[i_] - self.p_WB) + way_W / params_->period_s;
  }
  std::span<const double> Message() override { return {x_W_.data(), 3}; }

 private:
  const AverageTrackingParams* params_ = nullptr;  // the experiment owns them
  std::size_t i_;
  Eigen::Vector3d q_W_ = Eigen::Vector3d::Zero(), x_W_ = Eigen::Vector3d::Zero();
  bool has_x_ = false;
};

std::shared_ptr<const LawParams> ReadAverageTracking(const Experiment& experiment, const LawConfig& /*law*/,
                                                     Section& section) {
  auto params = std::make_shared<AverageTrackingParams>();
  params->sends_messages = true;
  params->gain = section.Number("gain");
  params->p_gain = section.Number("p_gain");
  params->period_s = experiment.period_s();
  params->d_W.resize(experiment.agents.size(), Eigen::Vector3d::Zero());
  if (section.Has("offsets_m") || section.Has("shape")) params->d_W = ReadPlaces(section, experiment.size());
  params->inputs = ReadInputs(experiment, section);
  return params;
}

std::span<const Eigen::Vector3d> PlacesOfAverageTracking(const LawConfig& law) {
  return ParamsOf<AverageTrackingParams>(law).d_W;
}

LawTheory PredictAverageTracking(const Experiment& experiment) {
  const auto& params = ParamsOf<AverageTrackingParams>(experiment.law);
  if (std::string why = WhyNotAllHeard(experiment); !why.empty()) return {.silent = std::move(why)};
  if (std::string why = WhyNotUndirected(experiment); !why.empty()) return {.silent = std::move(why)};
  const double step = experiment.period_s() * params.gain;
  if (SlowestFactor(experiment, step) >= 1) return UnstableGain(experiment);
  return {.figures = PredictTrackingError(experiment, params.inputs, step), .of_messages = true};
}

std::unique_ptr<LawMeter> MeterOfAverageTracking(const Experiment& experiment, std::span<const int> ids) {
  return std::make_unique<TrackingErrorMeter>(
      experiment, ids, ParamsOf<AverageTrackingParams>(experiment.agent(ids.front()).law).inputs);
}

}  // namespace

LawEntry AverageTrackingLaw() {
  return {
      .name = "average_tracking",
      .summary = "agents follow the average of inputs that change, of which each knows its own: by messages",
      .equation = "x_i = r_i + q_i,  dq_i/dt = gain sum_j a_ij (x_j - x_i);  v_i = p_gain (x_i + d_i - p_i) + dx_i/dt",
      .tex = R"(x_i = r_i + q_i, \quad \dot q_i = k \sum_j a_{ij} (x_j - x_i) \\
v_i = k_p (x_i + d_i - p_i) + \dot x_i)",
      .symbols = {{"gain", "k"}, {"p_gain", "k_p"}, {"offsets_m", "d_i"}},
      .graph = "undirected and connected",
      .details =
          "Sampled: q_i(k+1) = q_i(k) + h gain sum_j a_ij (x_j(k) - x_i(k)), q_i(0) = 0, with the estimates "
          "x_j of the tick before, which messages bring. dx_i/dt is the backward difference (x_i(k) - "
          "x_i(k-1)) / h, and 0 at the first tick.\n"
          "r_i(t) = inputs_m + ramps_m_per_s t + amplitudes_m sin(2 pi frequencies_hz t + phases_rad); "
          "inputs_m is by default the agent's start. d_i is 0 without offsets_m and shape.",
      .theory =
          "undirected and connected: sum x_i = sum r_i at every tick; x_i is off by |z - 1| / |z - 1 + h gain "
          "lambda| of a swing along each mode, z = exp(2 pi j f h), and by 1 / (gain lambda) of a ramp",
      .source =
          "Kia, Van Scoy, Cortes, Freeman, Lynch & Martinez, Tutorial on dynamic average consensus, IEEE Control "
          "Systems Magazine 39 (2019)",
      .parameters = kAverageTrackingParameters,
      .figures = kTrackingErrorFigures,
      .curve = LawCurve{.name = "tracking error",
                        .unit = "m",
                        .meaning = "of the estimate that is farthest from the average",
                        .figure = "tracking_error_m"},
      .agrees = true,
      .drawing = {.pictures = kDisagreementPicture},
      .read = ReadAverageTracking,
      .make = MakeOf<AverageTracking>,
      .wanted = WantsVelocity,
      .places_W = PlacesOfAverageTracking,
      .predict = PredictAverageTracking,
      .meter = MeterOfAverageTracking};
}

}  // namespace mascot
