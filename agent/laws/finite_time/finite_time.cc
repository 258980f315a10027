// Agreement of single integrators in finite time.
//   form = "sign",  Cortes (2006):       v_i = -gain sgn(sum_j a_ij (p_i - p_j)), sgn(0) = 0
//   form = "power", Wang & Xiao (2010):  v_i = gain sum_j a_ij sig(p_j - p_i)^alpha
// per axis, with sig(x)^alpha = sgn(x) |x|^alpha and 0 < alpha < 1. On a connected undirected graph,
//   sign:  all agents meet at (max p(0) + min p(0)) / 2 after (max p(0) - min p(0)) / (2 gain)
//   power: they meet at the mean of p(0), after at most 4 V^((1-alpha)/2) / ((1-alpha) (4 lambda)^((1+alpha)/2)), where
//          V = |p(0) - mean|^2 / 2 and lambda is lambda_2 of the Laplacian of the weights (gain a_ij)^(2/(1+alpha)).
// Both are of continuous time. Commands that are held for a tick h overshoot: agents do not meet exactly, but tremble
// in the end, with power by about (h gain sum_j a_ij)^(1/(1-alpha)), with sign by some ticks' ways, which add up along
// chains. Theory flies the sampled team ahead.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "agent/laws/finite_time/flown_agreement.h"
#include "agent/laws/finite_time/power_bound.h"
#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/pull.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/sgn.h"

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

constexpr LawFigure kFiniteTimeFigures[] = {
    {.name = "agreement_time_s",
     .meaning = "from which on all are within 0.1 % of their first spread, or with sign 4 gain T, along each axis"},
    {.name = "band_m", .meaning = "largest distance of two agents along an axis, in the last tenth of the run"},
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
    const auto sig = [alpha = params_->alpha](double x) { return Sgn(x) * std::pow(std::abs(x), alpha); };
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

/// With sign, all fly at one speed, and change direction at every tick or every other: this near counts as together.
double Together_m(const Experiment& experiment, const FiniteTimeParams& params) {
  return params.form == FiniteTimeForm::kSign ? 4 * params.gain * experiment.period_s() : 0;
}

/// The law of all agents at once.
WantedOfAll WantedOfTeam(const Experiment& experiment, const FiniteTimeParams& params) {
  return [edges = EdgesOf(experiment.graph), &params](std::int64_t, std::span<const Eigen::Vector3d> p_W, auto v_W) {
    const bool is_power = params.form == FiniteTimeForm::kPower;
    std::ranges::fill(v_W, Eigen::Vector3d::Zero());
    for (const HeardEdge& edge : edges) {
      const Eigen::Array3d way_W = p_W[edge.heard] - p_W[edge.hearer];
      v_W[edge.hearer] += edge.weight * (is_power ? way_W.sign() * way_W.abs().pow(params.alpha) : way_W).matrix();
    }
    for (Eigen::Vector3d& v : v_W) v = params.gain * (is_power ? v : v.cwiseSign().eval());
  };
}

/// The time that the closed forms of continuous time allow.
double LongestTime_s(const Experiment& experiment, const FiniteTimeParams& params) {
  if (params.form == FiniteTimeForm::kPower) return LongestTimeOfPower_s(experiment, params.gain, params.alpha);
  double slowest = params.gain;
  for (const AgentConfig& agent : experiment.agents) slowest = std::min(slowest, agent.control.max_speed_m_per_s);
  return LargestSpread(experiment, AgentsWith(EntryOf(experiment.law), experiment)) / (2 * slowest);
}

LawTheory PredictFiniteTime(const Experiment& experiment) {
  const auto& params = ParamsOf<FiniteTimeParams>(experiment.law);
  if (std::string why = WhyNotIdealUndirected(experiment); !why.empty()) return {.silent = std::move(why)};
  return PredictAgreement(experiment, WantedOfTeam(experiment, params), 2 * LongestTime_s(experiment, params) + 1,
                          kAgreedShare, Together_m(experiment, params));
}

std::unique_ptr<LawMeter> MeterOfFiniteTime(const Experiment& experiment, std::span<const int> ids) {
  const auto& params = ParamsOf<FiniteTimeParams>(experiment.agent(ids.front()).law);
  return std::make_unique<AgreementTime>(experiment, ids, kAgreedShare, Together_m(experiment, params));
}

}  // namespace

LawEntry FiniteTimeLaw() {
  return {
      .name = "finite_time",
      .summary = "single integrators meet in finite time, but for a trembling: the law wants a velocity",
      .equation = "v_i = gain sum_j a_ij sig(p_j - p_i)^alpha, per axis;  or  v_i = -gain sgn(sum_j a_ij (p_i - p_j))",
      .tex =
          R"(\text{power: } v_i = k \sum_j a_{ij}\, \mathrm{sig}(p_j - p_i)^\alpha \text{, per axis}, \quad \mathrm{sig}(x)^\alpha = \mathrm{sgn}(x)\, \lvert x \rvert^\alpha \\
\text{sign: } v_i = -k\, \mathrm{sgn} \Bigl( \sum_j a_{ij} (p_i - p_j) \Bigr))",
      .symbols = {{"gain", "k"}, {"alpha", R"(\alpha)"}},
      .graph = "undirected and connected",
      .details =
          "sig(x)^alpha = sgn(x) |x|^alpha and sgn(0) = 0. Both forms are per axis; with sign, the weighted "
          "sum is taken first and its sign then.",
      .theory =
          "undirected and connected: power meets at the mean of p(0), after at most 4 V^((1-alpha)/2) / "
          "((1-alpha) (4 lambda)^((1+alpha)/2)), V = |p(0) - mean|^2 / 2, lambda = lambda_2 of the Laplacian of the "
          "weights (gain a_ij)^(2/(1+alpha)); sign meets midway between the outermost agents, when these "
          "have flown there: (max p(0) - min p(0)) / (2 gain). Sampled, agents tremble about it: predicted as flown",
      .source =
          "sign: Cortes, Finite-time convergent gradient flows with applications to network consensus, Automatica 42 "
          "(2006); power: Wang & Xiao, Finite-time consensus problems for networks of dynamic agents, IEEE Trans. "
          "Autom. Control 55 (2010)",
      .parameters = kFiniteTimeParameters,
      .figures = kFiniteTimeFigures,
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
