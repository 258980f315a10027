// Consensus of agents that speak only when they have something to say; Seyboth, Dimarogonas & Johansson (2013):
//   v_i = gain sum_j a_ij (x_j - x_i)
// where x_i is what i said last of where it is, also to itself. It speaks when |e_i| = |x_i - p_i| exceeds a threshold
// (trigger.h). A message takes one tick: it says where the agent will be then, and the agent uses it from then on, so
// that |e_i| never exceeds the threshold and the mean is kept. On a connected undirected graph d = p - mean then obeys
//   |d(k+1)| <= r |d(k)| + h gain |L| sqrt(N) threshold(k),  r = max |1 - h gain lambda| < 1 over the modes
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "agent/laws/event_triggered/last_broadcast.h"
#include "agent/laws/event_triggered/trigger.h"
#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/sampled_modes.h"

namespace mascot {
namespace {

constexpr auto kEventTriggeredParameters = Joined(
    std::array{
        key::Number("gain", Above(0, 1000), "pull towards what each neighbour said, times its weight")
            .Default("1.0")
            .Unit("1/s")
            .Live(),
    },
    kTriggerKeys);

constexpr LawFigure kEventTriggeredFigures[] = {
    {.name = "disagreement_m", .meaning = "at the end: root of the sum of squares of distances from the mean"},
    {.name = "messages", .meaning = "sent", .each = "agent", .unpredicted = "it takes the whole motion"},
};

struct EventTriggeredParams final : LawParams {
  TriggerParams trigger;
};

class EventTriggered final : public Law {
 public:
  explicit EventTriggered(const AgentConfig& agent) : flies_as_wanted_(FliesAsWanted(agent)) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override {
    params_ = &ParamsOf<EventTriggeredParams>(agent.law).trigger;
    axes_ = agent.law.axes;
  }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    last_broadcast_.Hear(heard);
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    Trigger::Next next{.t_s = t_s + params_->period_s};
    for (const Heard& j : heard) {
      const std::span<const double> x_j = last_broadcast_.By(j.id);
      next.degree += j.weight;
      if (!x_i_W_ || x_j.size() != 3) continue;
      const Eigen::Vector3d way_W = Along(axes_, Eigen::Map<const Eigen::Vector3d>(x_j.data()) - *x_i_W_);
      v_W += params_->gain * j.weight * way_W;
      next.q_m2 += j.weight * way_W.squaredNorm() / 2;
    }
    const Eigen::Vector3d next_p_W = self.p_WB + params_->period_s * (flies_as_wanted_ ? v_W : self.v_WB);
    if (x_i_W_) next.squared_error_m2 = Along(axes_, *x_i_W_ - next_p_W).squaredNorm();
    speaks_ = trigger_.Fires(*params_, next) || !x_i_W_;
    if (speaks_) x_i_W_ = next_p_W;
    return v_W;
  }
  std::span<const double> Message() override {
    return speaks_ ? std::span<const double>(x_i_W_->data(), 3) : std::span<const double>();
  }

 private:
  static bool FliesAsWanted(const AgentConfig& agent) {
    return agent.traits().driven_by == Wanted::kVelocity && !agent.traits().rolls;
  }

  const TriggerParams* params_ = nullptr;  // the experiment owns them
  Axes axes_ = Axes::kXy;
  bool flies_as_wanted_;  // else its velocity lags, and is the best guess of where it goes in a tick
  Trigger trigger_;
  LastBroadcast last_broadcast_;
  std::optional<Eigen::Vector3d> x_i_W_;  // what this agent said last
  bool speaks_ = false;
};

std::shared_ptr<const LawParams> ReadEventTriggered(const Experiment& experiment, const LawConfig& /*law*/,
                                                    Section& section) {
  auto params = std::make_shared<EventTriggeredParams>();
  params->sends_messages = true;
  params->trigger = ReadTrigger(experiment, section);
  return params;
}

LawTheory PredictEventTriggered(const Experiment& experiment) {
  const TriggerParams& trigger = ParamsOf<EventTriggeredParams>(experiment.law).trigger;
  if (std::string why = WhyNotIdealUndirected(experiment); !why.empty()) return {.silent = std::move(why)};
  const double step = experiment.period_s() * trigger.gain, largest = step * LargestRoot(experiment);
  if (largest >= 2) return UnstableGain(experiment);
  if (trigger.is_dynamic && largest >= 1 - trigger.sigma / 2)
    return {.silent = "law.gain or law.sigma is too large for a proof"};
  if (trigger.is_dynamic)
    return {.figures = {NotPredicted(kOfStatic), {}}, .value_m = MeanStart(experiment), .unlimited = true};
  const double r = SlowestFactor(experiment, step), most = largest * std::sqrt(experiment.size());
  double d_m = StartDisagreement_m(experiment);
  for (std::int64_t k = 1; k < experiment.ticks(); ++k)  // nothing is heard at tick 0
    d_m = r * d_m + most * (trigger.c0_m + trigger.c1_m * std::exp(-trigger.alpha * experiment.time_s(k)));
  return {
      .figures = {{.values = {d_m}, .bound = Bound::kAtMost}, {}}, .value_m = MeanStart(experiment), .unlimited = true};
}

class EventTriggeredMeter final : public LawMeter {
 public:
  EventTriggeredMeter(const Experiment& experiment, std::span<const int> ids)
      : axes_(experiment.agent(ids.front()).law.axes), ids_(ids.begin(), ids.end()), sent_(ids.size()) {}

  void Add(const TeamRow& row) override {
    d_m_ = std::sqrt(SquaredDisagreement(row.motions, ids_, axes_));
    for (std::size_t k = 0; k < ids_.size(); ++k)
      sent_[k] += !row.messages[static_cast<std::size_t>(ids_[k] - 1)].empty();
  }
  std::vector<FigureValues> Figures() const override { return {{d_m_}, FigureValues(sent_.begin(), sent_.end())}; }
  std::optional<double> Curve() const override { return std::accumulate(sent_.begin(), sent_.end(), 0.0); }

 private:
  Axes axes_;
  std::vector<int> ids_;
  std::vector<double> sent_;  // by index in ids_
  double d_m_ = 0;
};

}  // namespace

LawEntry EventTriggeredLaw() {
  return {
      .name = "event_triggered",
      .summary = "single integrators meet, and speak only when they have something to say: the law wants a velocity",
      .equation = "v_i = gain sum_j a_ij (x_j - x_i);  i says x_i = p_i when |x_i - p_i| > c0 + c1 exp(-alpha t)",
      .tex = R"(v_i = k \sum_j a_{ij} (x_j - x_i) \\
\text{agent } i \text{ says } x_i = p_i \text{ when } \lvert x_i - p_i \rvert > c_0 + c_1 e^{-\alpha t})",
      .symbols = {{"gain", "k"}, {"c0_m", "c_0"}, {"c1_m", "c_1"}, {"alpha", R"(\alpha)"}},
      .graph = "undirected and connected",
      .details =
          "x_i is what i said last, also for i itself. A message takes one tick: it says where i will be by "
          "then, p_i + h v_i, and i is compared with what it said there, too. There v_i is what the law "
          "wants for a single integrator, and the body's own velocity for others, which lag. Before an agent "
          "has said anything it does not count.\n"
          "With trigger = \"dynamic\", i speaks when theta gain (d |e|^2 - sigma / 4 q) > eta, e = x_i - "
          "p_i, d = sum_j a_ij, q = sum_j a_ij |x_j - x_i|^2 / 2, and h times (-beta eta - gain (d |e|^2 - "
          "sigma / 4 q)) is added to eta at each tick. Distances are along law.axes.",
      .theory =
          "undirected and connected: the mean is kept, and |p - mean| <= |L| sqrt(N) c0 / lambda_2 in the end "
          "(static), or 0 (dynamic), for h gain lambda_n < 2, dynamic: < 1 - sigma / 2",
      .source =
          "Seyboth, Dimarogonas & Johansson, Event-based broadcasting for multi-agent average consensus, Automatica 49 "
          "(2013); dynamic trigger: Girard, Dynamic triggering mechanisms for event-triggered control, IEEE Trans. "
          "Autom. "
          "Control 60 (2015), for a network as in Yi, Liu, Dimarogonas & Johansson, Dynamic event-triggered and "
          "self-triggered control for multi-agent systems, ibid. 64 (2019)",
      .parameters = kEventTriggeredParameters,
      .figures = kEventTriggeredFigures,
      .curve = LawCurve{.name = "messages", .unit = "", .meaning = "sent so far, by all agents", .decays = false},
      .agrees = true,
      .gathers = true,
      .drawing = {.pictures = kDisagreementPicture, .telling = "disagreement"},
      .read = ReadEventTriggered,
      .make = MakeOf<EventTriggered>,
      .wanted = WantsVelocity,
      .predict = PredictEventTriggered,
      .meter = MeterOf<EventTriggeredMeter>};
}

}  // namespace mascot
