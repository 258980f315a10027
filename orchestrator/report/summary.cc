#include "orchestrator/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/laws.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/report/deviation.h"
#include "orchestrator/report/json.h"
#include "orchestrator/report/law_report.h"
#include "orchestrator/report/prediction_report.h"

namespace mascot {
namespace {

Json EdgesOf(const Graph& graph) {
  Json edges = Json::array();
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& heard : graph.HeardBy(id)) edges.push_back({id, heard.id, heard.weight});
  return edges;
}

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

Json Consensus(const Experiment& experiment, const Measured& measured, const Prediction& prediction) {
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

Json Safety(const Measured& measured, const std::optional<Contacts>& contacts, const Prediction& prediction) {
  Json safety;
  safety["min_separation_m"] = OrNull(measured.min_separation_m);
  safety["collisions"] = contacts ? Json(contacts->total()) : Json(nullptr);
  safety["contacts"] = nullptr;
  if (contacts)
    safety["contacts"] = {
        {"agents", contacts->agents}, {"ground", contacts->ground}, {"obstacles", contacts->obstacles}};
  safety["filtered_fraction"] = OrNull(measured.filtered_fraction);
  safety["infeasible_ticks"] = OrNull(measured.infeasible_ticks);
  safety["predicted"] = SafetyPredictionJson(prediction);
  return safety;
}

/// Bytes of the samples sent over an edge: states and messages, as on the wire.
std::uint64_t BytesOf(const EdgeTraffic& edge, const SampleSizes& sizes) {
  return edge.count.sent * (sizes.state + (edge.sends_messages ? sizes.message : 0)) +
         sizeof(double) * edge.count.numbers;
}

Json Links(const std::vector<EdgeTraffic>& traffic) {
  const SampleSizes sizes = SizesOfSamples();
  EdgeCount all;
  std::uint64_t all_bytes = 0;
  Json edges = Json::array();
  for (const EdgeTraffic& edge : traffic) {
    const EdgeCount& count = edge.count;
    const std::uint64_t bytes = BytesOf(edge, sizes);
    edges.push_back({{"hearer", edge.hearer},
                     {"heard", edge.heard},
                     {"sent", count.sent},
                     {"lost", count.lost},
                     {"late", count.late},
                     {"bytes", bytes}});
    all.sent += count.sent;
    all.lost += count.lost;
    all.late += count.late;
    all_bytes += bytes;
  }
  return {{"sent", all.sent}, {"lost", all.lost}, {"late", all.late}, {"bytes", all_bytes}, {"edges", edges}};
}

Json Formation(const Measured::Formation& formation) {
  Json offsets = Json::array();
  for (const Eigen::Vector3d& d_W : formation.offsets_m) offsets.push_back(VectorJson(d_W));
  return {{"final_rms_m", formation.final_rms_m}, {"worst_rms_m", formation.worst_rms_m}, {"offsets_m", offsets}};
}

Json ToJson(const Drawing& drawing) {
  return {{"leader", drawing.leader},
          {"switches", drawing.switches},
          {"pictures", std::vector<std::string_view>(drawing.pictures.begin(), drawing.pictures.end())},
          {"telling", drawing.telling},
          {"hull", drawing.hull},
          {"cells", drawing.cells}};
}

Json Fidelity(const Measured& measured) {
  const auto& fidelity = measured.fidelity;
  return {{"rms_m", fidelity ? Json(fidelity->rms_m) : Json(nullptr)},
          {"max_m", fidelity ? Json(fidelity->max_m) : Json(nullptr)},
          {"travelled_m", measured.travelled_m},
          {"failure", measured.fidelity_failure.empty() ? Json(nullptr) : Json(measured.fidelity_failure)}};
}

Json Realtime(const Pacing& pacing) {
  const auto spread = [](const Pacing::Spread& s) { return Json{{"p50", s[0]}, {"p99", s[1]}, {"max", s[2]}}; };
  return {{"misses", pacing.misses},
          {"tick_lateness_s", spread(pacing.tick_lateness_s)},
          {"command_age_s", spread(pacing.command_age_s)}};
}

/// A line of the text summary.
template <class... Values>
std::string Line(fmt::format_string<Values...> format, Values&&... values) {
  return fmt::format(format, std::forward<Values>(values)...) + "\n";
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
std::string NotCaughtUpText(const Measured& m, const Prediction& prediction) {
  const auto missed = [](const PursuitMeter::Edge& edge) { return !edge.time_s; };
  const auto count = std::ranges::count_if(m.minmax_edges, missed);
  if (count == 0) return "";
  const auto worst = std::ranges::max_element(
      m.minmax_edges, {}, [&](const PursuitMeter::Edge& edge) { return missed(edge) ? edge.end_m : -1; });
  return Line("caught up      not all, not for good ({} of {} edges): {}", count, m.minmax_edges.size(),
              WhyNotCaughtUp(*worst, prediction));
}

/// Text on agreement: mean position, decay rate and settling time, measured and predicted.
std::string ConsensusText(const Experiment& experiment, const Measured& m, const Prediction& prediction) {
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

/// "; tilt limited in 12 %, rotors in 3 %", or empty if neither was.
std::string AlsoLimited(const Measured& m) {
  if (m.tilt_limited_fraction + m.rotor_limited_fraction == 0) return "";
  return fmt::format("; tilt limited in {:.3g} %, rotors in {:.3g} %", 100 * m.tilt_limited_fraction,
                     100 * m.rotor_limited_fraction);
}

/// Text on the distance of agents, and what law.safety has to do with it.
std::string SeparationText(const Measured& m, const std::optional<Contacts>& contacts, const Prediction& prediction) {
  std::string text;
  if (m.min_separation_m)
    text += Line("separation     {:.3f} m at least, {} collisions", *m.min_separation_m,
                 contacts ? std::to_string(contacts->total()) : "an unknown number of");
  if (prediction.safety) text += Line("  predicted    {}", SafetyText(*prediction.safety));
  if (m.filtered_fraction)
    text += Line("filtered       {:.3g} % of commands by law.safety; {} ticks without a safe one",
                 100 * *m.filtered_fraction, *m.infeasible_ticks);
  return text;
}

/// Name of the ideal bodies that a run is compared with (docs/recording.md, fidelity).
std::string IdealBodies(const Experiment& experiment) {
  const auto by_velocity = std::ranges::count_if(
      experiment.agents, [](const AgentConfig& agent) { return agent.traits().driven_by == Wanted::kVelocity; });
  return by_velocity == 0                   ? "ideal double integrators"
         : by_velocity == experiment.size() ? "ideal single integrators"
                                            : "ideal single and double integrators";
}

}  // namespace

std::string SummaryJson(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts) {
  const Measured measured = meter.Result();
  const std::int64_t ticks = std::max<std::int64_t>(measured.rows - 1, 0);  // periods flown: rows are 0 .. ticks
  const double sim_s = experiment.time_s(ticks);
  Json json;
  json["format"] = kFormat;
  json["experiment"] = experiment.run.name;
  json["seed"] = experiment.run.seed;
  json["engine"] = facts.engine;
  json["mode"] = kModes.Name(experiment.run.mode);
  json["agents"] = experiment.size();
  json["ticks"] = ticks;
  json["sim_s"] = sim_s;
  json["wall_s"] = engine.wall_s;
  json["real_time_factor"] = engine.wall_s > 0 ? Json(sim_s / engine.wall_s) : Json(nullptr);
  json["ticks_per_s"] = engine.wall_s > 0 ? Json(static_cast<double>(ticks) / engine.wall_s) : Json(nullptr);
  json["exit"] = OrNull(facts.exit);
  json["failure"] = engine.failure.empty() ? Json(nullptr) : Json(engine.failure);
  json["samples"] = {{"topics", facts.topics}, {"recorded", facts.samples}, {"lost", engine.lost}};
  json["wire"] = {{"matches_graph", OrNull(engine.wire_matches_graph)}};
  json["graph"] = {{"edges", EdgesOf(experiment.graph)}};
  json["drawing"] = ToJson(EntryOf(experiment.law).drawing);
  json["consensus"] = Consensus(experiment, measured, prediction);
  json["control"] = {{"effort", OrNull(measured.effort_m2_per_s3)},
                     {"saturated_fraction", measured.saturated_fraction},
                     {"tilt_limited_fraction", measured.tilt_limited_fraction},
                     {"rotor_limited_fraction", measured.rotor_limited_fraction}};
  json["safety"] = Safety(measured, engine.contacts, prediction);
  if (const auto& formation = measured.formation) json["formation"] = Formation(*formation);
  if (const auto laws = meter.Laws(); !laws.empty()) json["laws"] = LawsJson(experiment, laws, prediction);
  json["links"] = Links(meter.Traffic());
  json["fidelity"] = Fidelity(measured);
  if (experiment.run.mode == Mode::kRealtime)
    json["realtime"] = engine.pacing ? Realtime(*engine.pacing) : Json(nullptr);
  json["startup_s"] = engine.startup_s;
  json["total_s"] = facts.total_s;
  return JsonText(json);
}

std::string SummaryText(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts) {
  const Measured m = meter.Result();
  if (m.rows == 0) return "nothing was recorded\n";
  const double sim_s = experiment.time_s(m.rows - 1);
  std::string text;
  text += Line("simulated      {:.2f} s in {:.2f} s: {:.1f} x real time", sim_s, engine.wall_s, sim_s / engine.wall_s);
  text += Line("recorded       {} rows, {} samples on {} topics, {} lost", m.rows, facts.samples, facts.topics,
               engine.lost);
  text += ConsensusText(experiment, m, prediction);
  text += Line("saturated      {:.3g} % of commands{}", 100 * m.saturated_fraction, AlsoLimited(m));
  if (engine.pacing) {
    const Pacing& pacing = *engine.pacing;
    text += Line("late           {} commands came after their tick; the last one was held, at most {:.3g} s old",
                 pacing.misses, pacing.command_age_s[2]);
    text +=
        Line("ticks          {:.3g} ms after they were due in the median, 99 % within {:.3g} ms, all within {:.3g} ms",
             1e3 * pacing.tick_lateness_s[0], 1e3 * pacing.tick_lateness_s[1], 1e3 * pacing.tick_lateness_s[2]);
  }
  text += SeparationText(m, engine.contacts, prediction);
  if (const auto& formation = m.formation)
    text += Line("formation      {:.4f} m rms off at the end, {:.4f} m at worst in the second half",
                 formation->final_rms_m, formation->worst_rms_m);
  text += LawsText(experiment, meter.Laws(), prediction);
  std::uint64_t sent = 0, lost = 0, late = 0;
  for (const EdgeTraffic& edge : meter.Traffic()) {
    sent += edge.count.sent;
    lost += edge.count.lost;
    late += edge.count.late;
  }
  if (lost + late > 0)
    text += Line("links          {} samples sent, {:.2f} % lost, {:.2f} % overtaken",
                 static_cast<unsigned long long>(sent), 100.0 * static_cast<double>(lost) / static_cast<double>(sent),
                 100.0 * static_cast<double>(late) / static_cast<double>(sent));
  if (!m.fidelity_failure.empty())
    text +=
        "fidelity       not measured, the law failed on " + IdealBodies(experiment) + ": " + m.fidelity_failure + "\n";
  if (m.fidelity && m.travelled_m > 0)
    text += Line("fidelity       {:.4f} m rms from {}: {:.2f} % of {:.1f} m travelled", m.fidelity->rms_m,
                 IdealBodies(experiment), 100 * m.fidelity->rms_m / m.travelled_m, m.travelled_m);
  return text;
}

}  // namespace mascot
