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

void AddAim(const Experiment& experiment, const Aim& measured, const Prediction& prediction, Figures& figures) {
  const Deviation deviation = Compare(experiment, measured, prediction);
  figures.AddVector("consensus.value_m", measured.value_m);
  figures.Add("consensus.final_disagreement_m", measured.final_disagreement_m);
  figures.Add("consensus.final_speed_m_per_s", measured.final_speed_m_per_s);
  figures.Add("consensus.settling_time_s", measured.settling_time_s);
  figures.Add("consensus.rate_per_s", measured.rate_per_s);
  if (!measured.minmax_edges.empty())
    figures.Add("consensus.minmax_edges",
                [edges = measured.minmax_edges, &prediction] { return Edges(edges, prediction); });
  AddPrediction(prediction, "consensus.predicted.", figures);
  figures.Add("consensus.deviation.value_m", deviation.value_m);
  figures.Add("consensus.deviation.settling_time_s", deviation.settling_time_s);
  figures.Add("consensus.deviation.rate_per_s", deviation.rate_per_s);
  figures.Add("consensus.deviation.minmax_time_s", deviation.minmax_time_s);
  if (!measured.formation) return;
  figures.Add("formation.final_rms_m", measured.formation->final_rms_m);
  figures.Add("formation.worst_rms_m", measured.formation->worst_rms_m);
  figures.Add("formation.offsets_m", [offsets_m = measured.formation->offsets_m] {
    Json offsets = Json::array();
    for (const Eigen::Vector3d& d_W : offsets_m) offsets.push_back(VectorJson(d_W));
    return offsets;
  });
}

std::string AimText(const Experiment& experiment, const Aim& m, const Prediction& prediction, const Figures& figures) {
  const auto figure = [&](const char* name) { return figures.Number(std::string("consensus.") + name); };
  const Eigen::Vector3d mean_m = *figures.Vector("consensus.value_m");
  std::string text = Line("mean position  {:.4f}, {:.4f}, {:.4f} m", mean_m.x(), mean_m.y(), mean_m.z());
  if (const auto value_m = figures.Vector("consensus.predicted.value_m"))
    text += Line("  predicted    {:.4f}, {:.4f}, {:.4f} m{}: {:.2g} m off", value_m->x(), value_m->y(), value_m->z(),
                 prediction.on_average ? " on average" : "", *figure("deviation.value_m"));
  text += Line("disagreement   {:.3g} m, speed {:.2g} m/s at the end", *figure("final_disagreement_m"),
               *figure("final_speed_m_per_s"));
  const auto rate = figure("rate_per_s"), predicted_rate = figure("predicted.rate_per_s");
  const bool of_rate = predicted_rate && prediction.of_agreement;
  if (rate && m.minmax_edges.empty())
    text += Line("decayed        at {:.4f} 1/s", *rate);
  else if (of_rate)
    text += "decayed        at no rate that can be measured: the disagreement fell too little, or rose again\n";
  if (of_rate)
    text += Line("  predicted    {:.4f} 1/s ({}){}", *predicted_rate, RateBasis(prediction),
                 DeviationText(figure("deviation.rate_per_s"), predicted_rate));
  else if (prediction.slowest_rate_per_s && prediction.of_agreement)
    text += Line("  predicted    {}", SlowestRateText(prediction));
  const auto settling_s = figure("settling_time_s"), predicted_s = figure("predicted.settling_time_s");
  const bool of_settling = predicted_s && prediction.of_agreement;
  if (settling_s)
    text += Line("settled        after {:.2f} s (2 %)", *settling_s);
  else if (of_settling)
    text += "settled        not by the end (2 %)\n";
  if (of_settling)
    text += Line("  predicted    {:.2f} s ({}){}", *predicted_s, SettlingBasis(experiment, prediction),
                 DeviationText(figure("deviation.settling_time_s"), predicted_s));
  if (const auto caught_up_s = MinmaxTime(m, prediction))
    text += Line("caught up      after {:.2f} s (latest edge, within {:g} m)", *caught_up_s, kCaughtUp_m);
  else
    text += NotCaughtUpText(m, prediction);
  if (const auto minmax_s = figure("predicted.minmax_time_s"))
    text += Line("  predicted    {}{:.2f} s (min-max, latest edge){}", AtMost(prediction.minmax_edges), *minmax_s,
                 DeviationText(figure("deviation.minmax_time_s"), minmax_s));
  if (m.formation)
    text += Line("formation      {:.4f} m rms off at the end, {:.4f} m at worst in the second half",
                 figures.Known("formation.final_rms_m"), figures.Known("formation.worst_rms_m"));
  return text;
}

}  // namespace mascot
