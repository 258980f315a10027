// Agreement of single integrators at a prescribed time T; Wang, Song, Hill & Krstic (2019):
//   v_i = (gain + mu_dot / mu) sum_j a_ij (p_j - p_i),  mu = (T / (T - t))^exponent,  mu_dot / mu = exponent / (T - t)
// and from T on v_i = gain sum_j a_ij (p_j - p_i), which keeps the agreement. In continuous time, on a connected
// undirected graph, the disagreement shrinks by exp(-gain lambda t) (1 - t / T)^(exponent lambda) along each mode: it
// is 0 at T for any start, and so is the velocity if exponent lambda_2 > 1. A gain without bound cannot be sampled: it
// ends at 1 / (2 h d), d the largest sum of weights that is heard. At T, max prod |1 - h lambda gain(t)| is left.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/pull.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr Key kPrescribedTimeParameters[] = {
    key::Number("time_s", Above(0, 1e6), "T: agents agree at this time, wherever they start").Required(),
    key::Number("exponent", {0, 1000}, "how steeply the gain grows; above 1 / lambda_2, agents arrive at rest")
        .Default("10.0")
        .Live(),
    key::Number("gain", {0, 1000}, "what the gain is beside that, also after time_s").Default("1.0").Unit("1/s").Live(),
};

constexpr LawFigure kPrescribedTimeFigures[] = {
    {.name = "agreement_time_s",
     .meaning = "from which on all are within 0.1 % of their first spread, along each axis",
     .unpredicted = "more of the disagreement may be left than counts as together"},
    {.name = "left_share", .meaning = "disagreement at time_s, in the mean square, as a share of that at the start"},
};
constexpr double kTogetherShare = 1e-3;  // of the largest spread at the start

struct PrescribedTimeParams final : LawParams {
  double time_s = 0, exponent = 0, gain = 0;
  double largest = 0;     ///< 1/s: the gain that the control period allows
  std::int64_t tick = 0;  ///< the first at or after time_s

  double At(double t_s) const {
    const double left_s = time_s - t_s;
    return std::min(left_s > 0 ? gain + exponent / left_s : gain, largest);
  }
};

class PrescribedTime final : public Law {
 public:
  explicit PrescribedTime(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<PrescribedTimeParams>(agent.law); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    return params_->At(t_s) * Pull_W(self, heard);
  }

 private:
  const PrescribedTimeParams* params_ = nullptr;  // the experiment owns them
};

std::shared_ptr<const LawParams> ReadPrescribedTime(const Experiment& experiment, const LawConfig& /*law*/,
                                                    Section& section) {
  auto params = std::make_shared<PrescribedTimeParams>();
  params->time_s = section.Number("time_s");
  params->exponent = section.Number("exponent");
  params->gain = section.Number("gain");
  params->largest = experiment.control.rate_hz / (2 * std::max(LargestDegree(experiment.graph), 1e-9));
  params->tick = std::llround(std::ceil(params->time_s * experiment.control.rate_hz - 1e-6));
  return params;
}

/// The largest share of a disagreement that is left at time_s, over the modes.
PredictedFigure LeftShare(const Experiment& experiment, const PrescribedTimeParams& params) {
  const Eigen::VectorXcd lambda = experiment.graph.Eigenvalues();
  Eigen::ArrayXd shares = Eigen::ArrayXd::Ones(lambda.size());
  shares(0) = 0;  // the mean is no disagreement
  for (std::int64_t k = 0; k < params.tick; ++k)
    shares *= 1 - experiment.period_s() * params.At(experiment.time_s(k)) * lambda.array().real();
  return {{shares.abs().maxCoeff()}, Bound::kAtMost, "", SizeOfStart_m(experiment) / StartDisagreement_m(experiment)};
}

LawTheory PredictPrescribedTime(const Experiment& experiment) {
  const auto& params = ParamsOf<PrescribedTimeParams>(experiment.law);
  if (std::string why = WhyNotIdealUndirected(experiment); !why.empty()) return {.silent = std::move(why)};
  if (params.tick > experiment.ticks())
    return {.silent = "law.time_s is after the end of the run", .holds_from = HoldsFrom{params.time_s, Bound::kAtMost}};
  LawTheory theory{.figures = {{}, LeftShare(experiment, params)}, .value_m = MeanStart(experiment), .unlimited = true};
  const double left = *theory.figures[1].values[0];
  // Any two of N agents are at most sqrt(2) |d| apart, where |d| is at most sqrt(N) / 2 times the spread at the start.
  if (left * std::sqrt(experiment.size() / 2.0) <= kTogetherShare)
    theory.figures[0] = {.values = {experiment.time_s(params.tick)}, .bound = Bound::kAtMost};
  else
    theory.warnings.push_back(fmt::format(
        "law.exponent: up to {:.2g} % of the disagreement is left at law.time_s: the control period bounds the gain by "
        "{:.4g} 1/s; try another exponent, a later time or a higher control.rate_hz",
        100 * left, params.largest));
  return theory;
}

class PrescribedTimeMeter final : public LawMeter {
 public:
  PrescribedTimeMeter(const Experiment& experiment, std::span<const int> ids)
      : time_(experiment, ids, kTogetherShare, 0),
        ids_(ids.begin(), ids.end()),
        axes_(experiment.agent(ids_.front()).law.axes),
        tick_(ParamsOf<PrescribedTimeParams>(experiment.agent(ids_.front()).law).tick) {}

  void Add(const TeamRow& row) override {
    time_.Add(row);
    const double now = SquaredDisagreement(row.motions, ids_, axes_);
    if (row.tick == 0) first_ = now;
    if (row.tick == tick_ && first_ > 0) left_share_ = std::sqrt(now / first_);
  }
  std::vector<FigureValues> Figures() const override { return {{time_.time_s()}, {left_share_}}; }

 private:
  AgreementTime time_;
  std::vector<int> ids_;
  Axes axes_;
  std::int64_t tick_;
  double first_ = 0;
  std::optional<double> left_share_;
};

}  // namespace

LawEntry PrescribedTimeLaw() {
  return {.name = "prescribed_time",
          .summary = "single integrators meet at a time that is given, wherever they start: the law wants a velocity",
          .equation = "v_i = (gain + exponent / (T - t)) sum_j a_ij (p_j - p_i);  from T on v_i = gain sum_j ...",
          .tex = R"(v_i = \Bigl( k + \frac{c}{T - t} \Bigr) \sum_j a_{ij} (p_j - p_i) \text{ for } t < T \\
v_i = k \sum_j a_{ij} (p_j - p_i) \text{ for } t \ge T)",
          .symbols = {{"gain", "k"}, {"exponent", "c"}, {"time_s", "T"}},
          .graph = "undirected and connected",
          .details =
              "The factor in front of the sum is at most 1 / (2 h d), h the control period and d the largest "
              "sum_j a_ij of an agent: in a tick no agent goes more than half the way to its neighbours.",
          .theory =
              "undirected and connected: all are at the mean of p(0) at T = time_s, but for a share that the "
              "control period h leaves, since it bounds the gain by 1 / (2 h max_i sum_j a_ij)",
          .source =
              "Wang, Song, Hill & Krstic, Prescribed-time consensus and containment control of networked multiagent "
              "systems, IEEE Trans. Cybernetics 49 (2019)",
          .parameters = kPrescribedTimeParameters,
          .figures = kPrescribedTimeFigures,
          .agrees = true,
          .gathers = true,
          .drawing = {.pictures = kDisagreementPicture, .telling = "disagreement"},
          .read = ReadPrescribedTime,
          .make = MakeOf<PrescribedTime>,
          .wanted = WantsVelocity,
          .predict = PredictPrescribedTime,
          .meter = MeterOf<PrescribedTimeMeter>};
}

}  // namespace mascot
