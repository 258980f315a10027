// Agreement of single integrators in finite time.
//   form = "sign",  Cortes (2006):       v_i = -gain sgn(sum_j a_ij (p_i - p_j)), sgn(0) = 0
//   form = "power", Wang & Xiao (2010):  v_i = gain sum_j a_ij sig(p_j - p_i)^alpha
// per axis, with sig(x)^alpha = sgn(x) |x|^alpha and 0 < alpha < 1. On a connected undirected graph,
//   sign:  all agents meet at (max p(0) + min p(0)) / 2 after (max p(0) - min p(0)) / (2 gain)
//   power: they meet at the mean of p(0), after at most 4 V^((1-alpha)/2) / ((1-alpha) (4 lambda)^((1+alpha)/2)), where
//          V = |p(0) - mean|^2 / 2 and lambda is lambda_2 of the Laplacian of the weights (gain a_ij)^(2/(1+alpha)).
// A held command overshoots the meeting point by at most one tick's way: agents tremble by that in the end.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/agreement.h"
#include "agent/laws/ideal.h"
#include "agent/laws/pull.h"
#include "agent/laws/row_parts.h"
#include "agent/laws/sgn.h"

namespace mascot {
namespace {

enum class FiniteTimeForm { kPower, kSign };
constexpr EnumNames<FiniteTimeForm, 2> kFiniteTimeForms({{FiniteTimeForm::kPower, "power"},
                                                         {FiniteTimeForm::kSign, "sign"}});

constexpr Key kFiniteTimeParameters[] = {
    key::OneOf("form", kFiniteTimeForms.names(),
               "power: speed grows with a power of the distance; sign: the same speed at any distance")
        .Default("\"power\""),
    key::Number("gain", Above(0, 1000), "with sign: the speed in m/s; with power: the speed at 1 m from one neighbour")
        .Default("1.0")
        .Unit("m^(1-alpha)/s")
        .Live(),
    key::Number("alpha", Above(0, 0.99), "with power: the exponent").Default("0.5").Live(),
};

constexpr double kAgreedShare = 1e-3;

struct FiniteTimeParams final : LawParams {
  FiniteTimeForm form = FiniteTimeForm::kPower;
  double gain = 0;
  double alpha = 0;
};

class FiniteTime final : public Law {
 public:
  explicit FiniteTime(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<FiniteTimeParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const bool is_power = params_->form == FiniteTimeForm::kPower;
    const double alpha = params_->alpha;
    const auto sig = [alpha](double x) { return Sgn(x) * std::pow(std::abs(x), alpha); };
    Eigen::Vector3d pull_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) {
      const Eigen::Vector3d way_W = j.motion.p_WB - self.p_WB;
      pull_W += j.weight * (is_power ? way_W.unaryExpr(sig).eval() : way_W);
    }
    return params_->gain * (is_power ? pull_W : pull_W.unaryExpr(&Sgn).eval());
  }

 private:
  const FiniteTimeParams* params_ = nullptr;  // the experiment owns them
};

std::shared_ptr<const LawParams> ReadFiniteTime(const Experiment& /*experiment*/, const LawConfig& /*law*/,
                                                Section& section) {
  auto params = std::make_shared<FiniteTimeParams>();
  params->form = kFiniteTimeForms.Value(section.OneOf("form"));
  params->gain = section.Number("gain");
  params->alpha = section.Number("alpha");
  return params;
}

/// lambda_2 of the Laplacian of the weights (gain a_ij)^(2/(1+alpha)).
double Lambda2OfPower(const Graph& graph, const FiniteTimeParams& params) {
  std::vector<std::vector<Graph::Neighbour>> heard;
  for (int id = 1; id <= graph.size(); ++id) {
    heard.push_back(graph.HeardBy(id));
    for (Graph::Neighbour& j : heard.back()) j.weight = std::pow(params.gain * j.weight, 2 / (1 + params.alpha));
  }
  return Graph(std::move(heard)).Lambda2();
}

/// The longest time until the agents meet along one axis of the law (Wang & Xiao).
double LongestTime(const Experiment& experiment, const FiniteTimeParams& params) {
  const Eigen::Vector3d mean_W = MeanStart(experiment);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  // V, per axis
  for (const AgentConfig& agent : experiment.agents) v += (agent.p_W - mean_W).cwiseAbs2() / 2;
  const double largest_v = v.head(CountOf(experiment.law.axes)).maxCoeff();
  if (largest_v == 0) return 0;
  const double alpha = params.alpha, lambda = Lambda2OfPower(experiment.graph, params);
  return 4 * std::pow(largest_v, (1 - alpha) / 2) / ((1 - alpha) * std::pow(4 * lambda, (1 + alpha) / 2));
}

LawTheory PredictFiniteTime(const Experiment& experiment) {
  const auto& params = ParamsOf<FiniteTimeParams>(experiment.law);
  if (std::string why = WhyNotIdealUndirected(experiment); !why.empty()) return {.silent = std::move(why)};
  if (params.form == FiniteTimeForm::kSign)
    return {.figures = {{.values = {LargestSpread(experiment, AgentsWith(EntryOf(experiment.law), experiment)) /
                                    (2 * params.gain)}}},
            .value_m = MiddleStart(experiment)};
  return {.figures = {{.values = {LongestTime(experiment, params)}, .bound = Bound::kAtMost}},
          .value_m = MeanStart(experiment)};
}

/// Agents that fly at the same speed and change direction at every tick or every other are at most this far apart in
/// the end (m).
double Trembling_m(const Experiment& experiment, const FiniteTimeParams& params) {
  return params.form == FiniteTimeForm::kSign ? 4 * params.gain * experiment.period_s() : 0;
}

std::unique_ptr<LawMeter> MeterOfFiniteTime(const Experiment& experiment, std::span<const int> ids) {
  const auto& params = ParamsOf<FiniteTimeParams>(experiment.agent(ids.front()).law);
  return std::make_unique<AgreementTime>(experiment, ids, kAgreedShare, Trembling_m(experiment, params));
}

}  // namespace

LawEntry FiniteTimeLaw() {
  return {
      .name = "finite_time",
      .summary = "single integrators meet in finite time, exactly: the law wants a velocity",
      .equation = "v_i = gain sum_j a_ij sig(p_j - p_i)^alpha, per axis;  or  v_i = -gain sgn(sum_j a_ij (p_i - p_j))",
      .theory =
          "undirected and connected: power meets at the mean of p(0), after at most 4 V^((1-alpha)/2) / "
          "((1-alpha) (4 lambda)^((1+alpha)/2)); sign meets midway between the outermost agents, when these "
          "have flown there: (max p(0) - min p(0)) / (2 gain)",
      .source =
          "sign: Cortes, Finite-time convergent gradient flows with applications to network consensus, Automatica 42 "
          "(2006); power: Wang & Xiao, Finite-time consensus problems for networks of dynamic agents, IEEE Trans. "
          "Autom. Control 55 (2010)",
      .parameters = kFiniteTimeParameters,
      .figures = kAgreementTimeFigures,
      .agrees = true,
      .gathers = true,
      .drawing = {.pictures = kDisagreementPicture, .telling = "disagreement"},
      .read = ReadFiniteTime,
      .make = MakeOf<FiniteTime>,
      .wanted = WantsVelocity,
      .predict = PredictFiniteTime,
      .meter = MeterOfFiniteTime};
}

}  // namespace mascot
