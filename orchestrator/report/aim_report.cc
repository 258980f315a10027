#include "orchestrator/report/aim_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/laws/laws.h"
#include "orchestrator/report/deviation.h"
#include "orchestrator/report/prediction_report.h"
#include "orchestrator/report/text_line.h"

namespace mascot {
namespace {

/// Why the time of an edge is null; empty: it is not.
std::string WhyNotCaughtUp(const PursuitMeter::Edge& edge, const Prediction& prediction) {
  if (edge.time_s) return "";
  std::string why = fmt::format("agent {} did not stay within {:g} m of agent {}: up to {:.2g} m away in the end",
                                edge.child, kCaughtUp_m, edge.parent, edge.end_m);
  const auto predicted = std::ranges::find(prediction.minmax_edges, edge.child, &MinmaxEdge::child);
  if (predicted == prediction.minmax_edges.end() || !predicted->trembling) return why;
  const Trembling& trembling = *predicted->trembling;
  return why + fmt::format(
                   "; theory expects that it trembles by about {:.2g} m, since it turns first, and so "
                   "accelerates {:.2g} s late",
                   trembling.radius_m, trembling.lag_s);
}

Json Edges(const std::vector<PursuitMeter::Edge>& measured, const Prediction& prediction) {
  Json edges = Json::array();
  for (const PursuitMeter::Edge& edge : measured) {
    const std::string why = WhyNotCaughtUp(edge, prediction);
    edges.push_back({{"child", edge.child},
                     {"parent", edge.parent},
                     {"time_s", OrNull(edge.time_s)},
                     {"end_m", edge.end_m},
                     {"why_null", why.empty() ? Json(nullptr) : Json(why)}});
  }
  return edges;
}

Json ToJson(const Deviation& deviation) {
  return {{"value_m", OrNull(deviation.value_m)},
          {"settling_time_s", OrNull(deviation.settling_time_s)},
          {"rate_per_s", OrNull(deviation.rate_per_s)},
          {"minmax_time_s", OrNull(deviation.minmax_time_s)}};
}

/// ": +1.2 %", or empty if there is no deviation.
std::string DeviationText(std::optional<double> deviation, std::optional<double> predicted) {
  if (!deviation || *predicted == 0) return "";
  return fmt::format(": {:+.3g} %", 100 * *deviation / *predicted);
}

/// "at most " if one of the times is only a bound, else empty.
const char* AtMost(const std::vector<MinmaxEdge>& edges) {
  return std::ranges::all_of(edges, &MinmaxEdge::exact) ? "" : "at most ";
}

/// The line for edges that have not caught up: about the one that is farthest apart in the end.
std::string NotCaughtUpText(const Aim& m, const Prediction& prediction) {
  const auto missed = [](const PursuitMeter::Edge& edge) { return !edge.time_s; };
  const auto count = std::ranges::count_if(m.minmax_edges, missed);
  if (count == 0) return "";
  const auto worst = std::ranges::max_element(
      m.minmax_edges, {}, [&](const PursuitMeter::Edge& edge) { return missed(edge) ? edge.end_m : -1; });
  return Line("caught up      not all, not for good ({} of {} edges): {}", count, m.minmax_edges.size(),
              WhyNotCaughtUp(*worst, prediction));
}

}  // namespace

Json AimJson(const Experiment& experiment, const Aim& measured, const Prediction& prediction) {
  Json consensus;
  consensus["value_m"] = VectorJson(measured.value_m);
  consensus["final_disagreement_m"] = measured.final_disagreement_m;
  consensus["final_speed_m_per_s"] = measured.final_speed_m_per_s;
  consensus["settling_time_s"] = OrNull(measured.settling_time_s);
  consensus["rate_per_s"] = OrNull(measured.rate_per_s);
  if (!measured.minmax_edges.empty()) consensus["minmax_edges"] = Edges(measured.minmax_edges, prediction);
  consensus["predicted"] = PredictionJson(prediction);
  consensus["deviation"] = ToJson(Compare(experiment, measured, prediction));
  return consensus;
}

Json FormationJson(const Aim::Formation& formation) {
  Json offsets = Json::array();
  for (const Eigen::Vector3d& d_W : formation.offsets_m) offsets.push_back(VectorJson(d_W));
  return {{"final_rms_m", formation.final_rms_m}, {"worst_rms_m", formation.worst_rms_m}, {"offsets_m", offsets}};
}

std::string AimText(const Experiment& experiment, const Aim& m, const Prediction& prediction) {
  const Deviation deviation = Compare(experiment, m, prediction);
  std::string text = Line("mean position  {:.4f}, {:.4f}, {:.4f} m", m.value_m.x(), m.value_m.y(), m.value_m.z());
  if (const auto& value = prediction.value_m)
    text += Line("  predicted    {:.4f}, {:.4f}, {:.4f} m{}: {:.2g} m off", value->x(), value->y(), value->z(),
                 prediction.on_average ? " on average" : "", *deviation.value_m);
  text += Line("disagreement   {:.3g} m, speed {:.2g} m/s at the end", m.final_disagreement_m, m.final_speed_m_per_s);
  const bool of_rate = prediction.rate_per_s && prediction.of_agreement;
  if (m.rate_per_s && m.minmax_edges.empty())
    text += Line("decayed        at {:.4f} 1/s", *m.rate_per_s);
  else if (of_rate)
    text += "decayed        not far enough, or not for good, to say how fast\n";
  if (of_rate)
    text += Line("  predicted    {:.4f} 1/s ({}){}", *prediction.rate_per_s, RateBasis(prediction),
                 DeviationText(deviation.rate_per_s, prediction.rate_per_s));
  else if (prediction.slowest_rate_per_s && prediction.of_agreement)
    text += Line("  predicted    {}", SlowestRateText(prediction));
  const bool of_settling = prediction.settling_time_s && prediction.of_agreement;
  if (m.settling_time_s)
    text += Line("settled        after {:.2f} s (2 %)", *m.settling_time_s);
  else if (of_settling)
    text += "settled        not by the end (2 %)\n";
  if (of_settling)
    text += Line("  predicted    {:.2f} s ({}){}", *prediction.settling_time_s, SettlingBasis(experiment, prediction),
                 DeviationText(deviation.settling_time_s, prediction.settling_time_s));
  if (const auto caught_up_s = MinmaxTime(m, prediction))
    text += Line("caught up      after {:.2f} s (latest edge, within {:g} m)", *caught_up_s, kCaughtUp_m);
  else
    text += NotCaughtUpText(m, prediction);
  if (prediction.minmax_time_s)
    text += Line("  predicted    {}{:.2f} s (min-max, latest edge){}", AtMost(prediction.minmax_edges),
                 *prediction.minmax_time_s, DeviationText(deviation.minmax_time_s, prediction.minmax_time_s));
  return text;
}

}  // namespace mascot
