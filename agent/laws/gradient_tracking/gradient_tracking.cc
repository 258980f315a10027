// Agents minimise the sum of their own costs f_i(x) = (x - b_i)' Q_i (x - b_i) / 2 by messages: DIGing of Nedic,
// Olshevsky & Shi (2017). At each tick
//   x_i+ = sum_j w_ij x_j - step y_i,  y_i+ = sum_j w_ij y_j + grad f_i(x_i+) - grad f_i(x_i),  y_i = grad f_i(x_i) at
//   first
// with Metropolis weights w_ij = 1 / (1 + max(d_i, d_j)) of the numbers d of agents that i and j hear, and w_ii = 1 -
// sum_j w_ij. Agents say x_i, y_i and d_i; a message takes one tick, which is the one of this iteration. On a connected
// undirected graph W is doubly stochastic, so that sum y = sum grad f(x) at every tick; for a small step x_i goes to
// (sum Q)^-1 sum Q b at a linear rate: that of the slowest mode that the start excites of
//   x+ = W x - step y,  y+ = W y + Q (x+ - x)
// Each agent starts at its own place, and flies to its estimate: v_i = p_gain (x_i - p_i).
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/gradient_tracking/gradient_modes.h"
#include "agent/laws/gradient_tracking/quadratic_costs.h"
#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/stable_period.h"

namespace mascot {
namespace {

constexpr auto kGradientTrackingParameters = Joined(
    std::array{
        key::Number("step", Above(0, 1000), "how far the estimate goes against the gradient in a tick, per unit of Q")
            .Default("0.05")
            .Live(),
        key::Number("p_gain", {0, 1000}, "pull of the agent towards its estimate").Default("2.0").Unit("1/s").Live(),
    },
    kCostKeys);

constexpr LawFigure kGradientTrackingFigures[] = {
    {.name = "rate_per_s",
     .meaning =
         "at which estimates approach the minimum, from the last row above 1e-7 of the start to that above 1e-12"},
    {.name = "error_m", .meaning = "largest distance of an estimate from the minimum, at the end"},
};

struct GradientTrackingParams final : LawParams {
  double step = 0;
  double p_gain = 0;                 ///< 1/s
  std::vector<QuadraticCost> costs;  ///< by id - 1
};

class GradientTracking final : public Law {
 public:
  explicit GradientTracking(const AgentConfig& agent) : i_(static_cast<std::size_t>(agent.id - 1)) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<GradientTrackingParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    if (has_said_)
      Iterate(heard);
    else
      Say(self.p_WB, params_->costs[i_].Gradient(self.p_WB));
    said_[6] = static_cast<double>(heard.size());
    return params_->p_gain * (x_W() - self.p_WB);
  }
  std::span<const double> Message() override { return said_; }

 private:
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  Vector x_W() const { return Vector(said_.data()); }
  Vector y_W() const { return Vector(said_.data() + 3); }

  void Say(const Eigen::Vector3d& x_W, const Eigen::Vector3d& y_W) {
    Eigen::Map<Eigen::Vector3d>(said_.data()) = x_W;
    Eigen::Map<Eigen::Vector3d>(said_.data() + 3) = y_W;
    has_said_ = true;
  }

  void Iterate(std::span<const Heard> heard) {
    Eigen::Vector3d x_new_W = x_W() - params_->step * y_W(), y_new_W = y_W();
    for (const Heard& j : heard) {
      if (j.message.size() != said_.size()) continue;
      const double w = MetropolisWeight(said_[6], j.message[6]);
      x_new_W += w * (Vector(j.message.data()) - x_W());
      y_new_W += w * (Vector(j.message.data() + 3) - y_W());
    }
    Say(x_new_W, y_new_W + params_->costs[i_].q * (x_new_W - x_W()));
  }

  const GradientTrackingParams* params_ = nullptr;  // the experiment owns them
  std::size_t i_;
  std::array<double, 7> said_ = {};  // x_i, y_i, d_i
  bool has_said_ = false;
};

std::shared_ptr<const LawParams> ReadGradientTracking(const Experiment& experiment, const LawConfig& /*law*/,
                                                      Section& section) {
  auto params = std::make_shared<GradientTrackingParams>();
  params->sends_messages = true;
  params->step = section.Number("step");
  params->p_gain = section.Number("p_gain");
  params->costs = ReadCosts(experiment, section);
  return params;
}

LawTheory PredictGradientTracking(const Experiment& experiment) {
  const auto& params = ParamsOf<GradientTrackingParams>(experiment.law);
  if (std::string why = WhyNotAllHeard(experiment); !why.empty()) return {.silent = std::move(why)};
  if (std::string why = WhyNotUndirected(experiment); !why.empty()) return {.silent = std::move(why)};
  if (experiment.size() > kMaxGradientModes) return {.silent = "the modes of so many agents are not computed"};
  const double radius = GradientRadius(experiment.graph, params.costs, params.step);
  if (radius >= 1)
    return {.silent = kUnstable, .warnings = {UnstableStep(experiment.graph, params.costs, params.step)}};
  Eigen::Vector3d value_W = Minimiser(params.costs);
  if (experiment.law.axes == Axes::kXy) value_W.z() = MeanStart(experiment).z();
  const GradientApproach approach = ApproachOf(experiment, params.costs, params.step, radius);
  if (!approach.silent.empty()) return {.silent = approach.silent, .value_m = value_W, .of_messages = true};
  return {
      .figures = {approach.rate, NotPredicted("what is known is how fast it falls, rate_per_s, and not from where")},
      .value_m = value_W,
      .of_messages = true,
      .holds_from = approach.holds_from};
}

std::unique_ptr<LawMeter> MeterOfGradientTracking(const Experiment& experiment, std::span<const int> ids) {
  const auto& params = ParamsOf<GradientTrackingParams>(experiment.agent(ids.front()).law);
  return std::make_unique<GradientMeter>(experiment, ids, Minimiser(params.costs));
}

}  // namespace

LawEntry GradientTrackingLaw() {
  return {.name = "gradient_tracking",
          .summary = "agents minimise the sum of their own quadratic costs by messages, and fly to where it is least",
          .equation =
              "x_i+ = sum_j w_ij x_j - step y_i,  y_i+ = sum_j w_ij y_j + Q_i (x_i+ - x_i);  v_i = p_gain (x_i - "
              "p_i)",
          .tex = R"(x_i^+ = \sum_j w_{ij} x_j - \eta\, y_i, \quad y_i^+ = \sum_j w_{ij} y_j + Q_i (x_i^+ - x_i) \\
v_i = k_p (x_i - p_i))",
          .symbols = {{"step", R"(\eta)"}, {"p_gain", "k_p"}, {"weights", "Q_i"}},
          .graph = "undirected and connected",
          .details =
              "x_i and y_i start as the agent's position and Q_i (x_i - b_i). An iteration takes a tick: x_j "
              "and y_j are those of the message of the tick before.\n"
              "w_ij = 1 / (1 + max(d_i, d_j)), d the number of agents that i and j hear, and w_ii = 1 - sum_j "
              "w_ij (Metropolis weights); weights of the graph do not count.",
          .theory =
              "undirected and connected: x_i goes to (sum Q)^-1 sum Q b at a linear rate, that of the slowest mode "
              "of this iteration that the start excites, for a small step",
          .source =
              "Nedic, Olshevsky & Shi, Achieving geometric convergence for distributed optimization over time-varying "
              "graphs, SIAM J. Optimization 27 (2017)",
          .parameters = kGradientTrackingParameters,
          .figures = kGradientTrackingFigures,
          .curve = LawCurve{.name = "distance to the minimum", .unit = "m", .meaning = "of the farthest estimate"},
          .agrees = true,
          .gathers = true,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadGradientTracking,
          .make = MakeOf<GradientTracking>,
          .wanted = WantsVelocity,
          .predict = PredictGradientTracking,
          .meter = MeterOfGradientTracking};
}

}  // namespace mascot
