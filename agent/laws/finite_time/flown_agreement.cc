#include "agent/laws/finite_time/flown_agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "agent/laws/laws.h"
#include "agent/laws/parts/agreement.h"

namespace mascot {
namespace {

constexpr int kFlights = 3;
constexpr double kShift_m = 1e-9;

/// One flight, at its end.
struct FlownTeam {
  std::optional<double> time_s;
  double band_m = 0;
  double fastest = 0;  ///< largest speed along an axis in the last tenth of the run (m/s)
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
};

/// Numbers in [-1, 1] that are spread evenly, and the same everywhere.
double EvenlySpread(int k) {
  constexpr double kGoldenRatio = 0.61803398874989485;
  return 2 * std::fmod(k * kGoldenRatio, 1.0) - 1;
}

/// Agents that all start at one place stay there, and are not shifted.
std::vector<Eigen::Vector3d> ShiftedStarts(const Experiment& experiment, int flight) {
  std::vector<Eigen::Vector3d> p_W;
  const double shift_m = StartDisagreement_m(experiment) > 0 ? kShift_m : 0;
  for (const AgentConfig& agent : experiment.agents) {
    const int k = 6 * agent.id + 3 * flight;
    p_W.emplace_back(agent.p_W);
    if (flight > 0) p_W.back() += shift_m * Eigen::Vector3d(EvenlySpread(k), EvenlySpread(k + 1), EvenlySpread(k + 2));
  }
  return p_W;
}

FlownTeam FlyOnce(const Experiment& experiment, const WantedOfAll& want, std::int64_t longest, AgreementTime meter,
                  int flight) {
  constexpr std::int64_t kPatience = 100;  // ticks for which a team that agrees is watched at least
  std::vector<Eigen::Vector3d> p_W = ShiftedStarts(experiment, flight), v_W(p_W.size());
  std::vector<Motion> motions(p_W.size());
  FlownTeam flown;
  for (std::int64_t tick = 0;; ++tick) {
    for (std::size_t i = 0; i < p_W.size(); ++i) motions[i].p_WB = p_W[i];
    meter.Add({.tick = tick, .motions = motions, .commands = {}, .messages = {}});
    flown.time_s = meter.time_s();
    const double agreed = flown.time_s ? static_cast<double>(tick) - *flown.time_s * experiment.control.rate_hz : -1;
    const bool for_good = agreed > kPatience + static_cast<double>(tick) / 6;
    const bool together = flown.time_s && (tick == experiment.ticks() || for_good);
    if (tick >= experiment.ticks() && (together || tick >= longest)) break;
    want(tick, p_W, v_W);
    double fastest = 0;
    for (std::size_t i = 0; i < p_W.size(); ++i) {
      const double limit = experiment.agents[i].control.max_speed_m_per_s;
      v_W[i] = Along(experiment.law.axes, v_W[i].cwiseMin(limit).cwiseMax(-limit));
      p_W[i] += experiment.period_s() * v_W[i];
      fastest = std::max(fastest, v_W[i].cwiseAbs().maxCoeff());
    }
    if (10 * tick > 9 * experiment.ticks() && tick <= experiment.ticks())
      flown.fastest = std::max(flown.fastest, fastest);
  }
  flown.band_m = meter.band_m();
  for (const Eigen::Vector3d& p : p_W) flown.mean_W += p / static_cast<double>(p_W.size());
  return flown;
}

std::string NotTogether(const Experiment& experiment, double band_m, double tolerance_m) {
  return fmt::format(
      "control.rate_hz: agents do not meet exactly, because commands are held for {:.4g} s: they end up to {:.2g} m "
      "apart along an axis, and nothing says when they are within {:.2g} m for good, as agreement_time_s asks; a "
      "higher "
      "rate or a smaller law.gain brings them closer",
      experiment.period_s(), band_m, tolerance_m);
}

}  // namespace

std::vector<HeardEdge> EdgesOf(const Graph& graph) {
  std::vector<HeardEdge> edges;
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& j : graph.HeardBy(id))
      edges.push_back({static_cast<std::size_t>(id - 1), static_cast<std::size_t>(j.id - 1), j.weight});
  return edges;
}

LawTheory PredictAgreement(const Experiment& experiment, const WantedOfAll& want, double longest_s, double share,
                           double min_m) {
  const double each_tick = kFlights * static_cast<double>(experiment.graph.edges() + experiment.agents.size());
  const double most = kMaxFlownEdges / each_tick, h = experiment.period_s();
  if (static_cast<double>(experiment.ticks()) > most)
    return {.silent = "so many agents are not flown ahead for so many ticks"};
  const auto longest = static_cast<std::int64_t>(std::min(most, longest_s * experiment.control.rate_hz));
  const std::vector<int> ids = AgentsWith(EntryOf(experiment.law), experiment);
  const AgreementTime meter(experiment, ids, share, min_m);
  const FlownTeam own = FlyOnce(experiment, want, longest, meter, 0);
  LawTheory theory{.value_m = own.mean_W};
  std::optional<double> time_s = own.time_s;
  double band_m = 1.1 * own.band_m + h * own.fastest;
  for (int k = 1; k < kFlights; ++k) {
    const FlownTeam other = FlyOnce(experiment, want, longest, meter, k);
    band_m = std::max(band_m, 1.1 * other.band_m + h * other.fastest);
    if (!time_s || !other.time_s || std::abs(*time_s - *other.time_s) > std::max(2.01 * h, 0.01 * *time_s))
      time_s.reset();
    if ((other.mean_W - own.mean_W).cwiseAbs().maxCoeff() > std::max(meter.tolerance_m(), h * own.fastest))
      theory.value_m.reset();
  }
  theory.figures = {
      {.values = {time_s}, .why = time_s ? "" : "agents do not meet exactly: commands are held for a tick"},
      {.values = {band_m}, .bound = Bound::kAtMost}};
  if (time_s) theory.holds_from = {*time_s};
  if (!time_s) theory.warnings.push_back(NotTogether(experiment, band_m, meter.tolerance_m()));
  if (!theory.value_m) theory.warnings.push_back("control.rate_hz: rounding decides about which point agents tremble");
  return theory;
}

}  // namespace mascot
