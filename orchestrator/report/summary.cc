#include "orchestrator/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "agent/laws/laws.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/report/aim_report.h"
#include "orchestrator/report/incident_report.h"
#include "orchestrator/report/json.h"
#include "orchestrator/report/law_report.h"
#include "orchestrator/report/prediction_report.h"
#include "orchestrator/report/text_line.h"

namespace mascot {
namespace {

Json EdgesOf(const Graph& graph) {
  Json edges = Json::array();
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& heard : graph.HeardBy(id)) edges.push_back({id, heard.id, heard.weight});
  return edges;
}

/// Edges: who hears whom at any time and, if the graph switches, when.
Json GraphJson(const Experiment& experiment) {
  Json graph = {{"edges", EdgesOf(experiment.graph)}};
  if (experiment.schedule.phases().size() == 1) return graph;
  graph["schedule"] = Json::array();
  for (const Schedule::Phase& phase : experiment.schedule.phases())
    graph["schedule"].push_back({{"at_s", phase.at_s}, {"edges", EdgesOf(phase.graph)}});
  return graph;
}

/// The first contacts, each with when, who, with what and how fast.
Json FirstContacts(const Experiment& experiment, const Contacts& contacts) {
  constexpr std::size_t kMost = 10;  // events.csv has more
  Json first = Json::array();
  for (const Contact& contact : std::span(contacts.first).first(std::min(kMost, contacts.first.size())))
    first.push_back({{"t_s", experiment.time_s(contact.tick)},
                     {"agent", contact.agent},
                     {"with", PartnerOf(contact)},
                     {"speed_m_per_s", contact.speed_m_per_s}});
  return first;
}

/// Why the promise of law.safety does not stand in this run, by what was measured; empty: its condition held, as far as
/// is known, or it has none.
std::string BrokenCondition(const Measured& measured, const Prediction& prediction) {
  const auto& safety = prediction.safety;
  if (!safety || !safety->min_separation_m || safety->assumes.empty()) return "";
  if (measured.infeasible_ticks && *measured.infeasible_ticks > 0)
    return fmt::format("at {} ticks an agent had no safe command", *measured.infeasible_ticks);
  const bool nearer = measured.min_separation_along_axes_m < safety->min_separation_m;
  return safety->assumes_prompt_bodies && nearer ? "quadrotors accelerated later than they were told" : "";
}

Json Safety(const Experiment& experiment, const Measured& measured, const std::optional<Contacts>& contacts,
            const Prediction& prediction) {
  Json safety;
  safety["min_separation_m"] = OrNull(measured.min_separation_m);
  safety["min_separation_along_axes_m"] = OrNull(measured.min_separation_along_axes_m);
  safety["collisions"] = contacts ? Json(contacts->total()) : Json(nullptr);
  safety["contacts"] = nullptr;
  if (contacts)
    safety["contacts"] = {{"agents", contacts->agents},
                          {"ground", contacts->ground},
                          {"obstacles", contacts->obstacles},
                          {"first", FirstContacts(experiment, *contacts)}};
  safety["filtered_fraction"] = OrNull(measured.filtered_fraction);
  safety["infeasible_ticks"] = OrNull(measured.infeasible_ticks);
  safety["predicted"] = SafetyPredictionJson(prediction);
  const std::string broken = BrokenCondition(measured, prediction);
  safety["condition_broken"] = broken.empty() ? Json(nullptr) : Json(broken);
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

Json ToJson(const Drawing& drawing) {
  return {{"leader", drawing.leader},
          {"switches", drawing.switches},
          {"pictures", std::vector<std::string_view>(drawing.pictures.begin(), drawing.pictures.end())},
          {"telling", drawing.telling},
          {"hull", drawing.hull},
          {"cells", drawing.cells}};
}

/// What the law of a phase is for, and measures.
Json PhaseJson(const RunMeter& meter, std::size_t k, const Prediction& run) {
  const PhaseMeter& phase = meter.phases()[k];
  const Prediction& prediction = PredictionOf(run, k);
  const Aim aim = phase.aim();
  Json json;
  json["consensus"] = AimJson(phase.experiment(), aim, prediction);
  if (aim.formation) json["formation"] = FormationJson(*aim.formation);
  if (const auto laws = meter.LawsOf(k); !laws.empty()) json["laws"] = LawsJson(phase.experiment(), laws, prediction);
  return json;
}

Json Phases(const Experiment& experiment, const RunMeter& meter, const Prediction& prediction) {
  Json phases = Json::array();
  for (std::size_t k = 0; k < meter.phases().size(); ++k) {
    const PhaseMeter& phase = meter.phases()[k];
    Json json = {{"at_s", experiment.time_s(phase.from())},
                 {"law", phase.experiment().law.name},
                 {"drawing", ToJson(EntryOf(phase.experiment().law).drawing)}};
    json.update(PhaseJson(meter, k, prediction));
    phases.push_back(std::move(json));
  }
  return phases;
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

/// "; tilt limited in 12 %, rotors in 3 %", or empty if neither was.
std::string AlsoLimited(const Measured& m) {
  if (m.tilt_limited_fraction + m.rotor_limited_fraction == 0) return "";
  return fmt::format("; tilt limited in {:.3g} %, rotors in {:.3g} %", 100 * m.tilt_limited_fraction,
                     100 * m.rotor_limited_fraction);
}

/// " (1.002 m in the plane)", where that is another distance than in space.
std::string InPlaneText(const Measured& m) {
  if (m.min_separation_along_axes_m == m.min_separation_m) return "";
  return fmt::format(" ({:.3f} m in the plane)", *m.min_separation_along_axes_m);
}

/// Text on the distance of agents, and what law.safety has to do with it.
std::string SeparationText(const Measured& m, const std::optional<Contacts>& contacts, const Prediction& prediction) {
  std::string text;
  if (m.min_separation_m)
    text += Line("separation     {:.3f} m at least{}, {} collisions", *m.min_separation_m, InPlaneText(m),
                 contacts ? std::to_string(contacts->total()) : "an unknown number of");
  if (prediction.safety) text += Line("  predicted    {}", SafetyText(*prediction.safety));
  if (const std::string broken = BrokenCondition(m, prediction); !broken.empty())
    text += Line("  but          the condition did not hold in this run: {}", broken);
  if (m.filtered_fraction)
    text += Line("filtered       {:.3g} % of commands by law.safety; {} ticks without a safe one",
                 100 * *m.filtered_fraction, *m.infeasible_ticks);
  return text;
}

/// What a phase has come to; with its begin and its law in front if it is one of several.
std::string PhaseText(const Experiment& experiment, const RunMeter& meter, std::size_t k, const Prediction& run) {
  const PhaseMeter& phase = meter.phases()[k];
  const Prediction& prediction = PredictionOf(run, k);
  const Aim aim = phase.aim();
  std::string text;
  if (meter.phases().size() > 1)
    text +=
        Line("from {:<9} law {}", fmt::format("{:g} s", experiment.time_s(phase.from())), phase.experiment().law.name);
  text += AimText(phase.experiment(), aim, prediction);
  if (const auto& formation = aim.formation)
    text += Line("formation      {:.4f} m rms off at the end, {:.4f} m at worst in the second half",
                 formation->final_rms_m, formation->worst_rms_m);
  text += LawsText(phase.experiment(), meter.LawsOf(k), prediction);
  if (!prediction.silent.empty()) text += "theory         silent, because " + prediction.silent + "\n";
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

/// The first keys of a summary.
Json WhoseSummary(const Experiment& experiment, const std::string& engine) {
  return {{"format", kFormat}, {"experiment", experiment.run.name},        {"seed", experiment.run.seed},
          {"engine", engine},  {"mode", kModes.Name(experiment.run.mode)}, {"agents", experiment.size()}};
}

}  // namespace

std::string SummaryOfTheUnknown(const Experiment& experiment, const std::string& engine, std::optional<int> exit,
                                const std::string& failure) {
  Json json = WhoseSummary(experiment, engine);
  json["exit"] = OrNull(exit);
  json["failure"] = failure;
  return JsonText(json);
}

std::string SummaryJson(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts) {
  const Measured measured = meter.Result();
  const std::int64_t ticks = std::max<std::int64_t>(measured.rows - 1, 0);  // periods flown: rows are 0 .. ticks
  const double sim_s = experiment.time_s(ticks);
  Json json = WhoseSummary(experiment, facts.engine);
  json["ticks"] = ticks;
  json["sim_s"] = sim_s;
  json["wall_s"] = engine.wall_s;
  json["real_time_factor"] = engine.wall_s > 0 ? Json(sim_s / engine.wall_s) : Json(nullptr);
  json["ticks_per_s"] = engine.wall_s > 0 ? Json(static_cast<double>(ticks) / engine.wall_s) : Json(nullptr);
  json["exit"] = OrNull(facts.exit);
  json["failure"] = engine.failure.empty() ? Json(nullptr) : Json(engine.failure);
  json["samples"] = {{"topics", facts.topics}, {"recorded", facts.samples}, {"lost", engine.lost}};
  json["wire"] = {{"matches_graph", OrNull(engine.wire_matches_graph)}};
  json["graph"] = GraphJson(experiment);
  const std::size_t last = meter.phases().size() - 1;
  json["drawing"] = ToJson(EntryOf(meter.phases()[last].experiment().law).drawing);
  json.update(PhaseJson(meter, last, prediction));
  if (meter.phases().size() > 1) json["phases"] = Phases(experiment, meter, prediction);
  json["control"] = {{"effort", OrNull(measured.effort_m2_per_s3)},
                     {"saturated_fraction", measured.saturated_fraction},
                     {"tilt_limited_fraction", measured.tilt_limited_fraction},
                     {"rotor_limited_fraction", measured.rotor_limited_fraction}};
  json["safety"] = Safety(experiment, measured, engine.contacts, prediction);
  json["links"] = Links(meter.Traffic());
  json["fidelity"] = Fidelity(measured);
  if (experiment.run.mode == Mode::kRealtime)
    json["realtime"] = engine.pacing ? Realtime(*engine.pacing) : Json(nullptr);
  json["startup_s"] = engine.startup_s;
  json["total_s"] = facts.total_s;
  return JsonText(json);
}

std::string SummaryText(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts, const Incidents& incidents) {
  const Measured m = meter.Result();
  if (m.rows == 0) return "nothing was recorded\n";
  const double sim_s = experiment.time_s(m.rows - 1);
  std::string text;
  text += Line("simulated      {:.2f} s in {:.2f} s: {:.1f} x real time", sim_s, engine.wall_s, sim_s / engine.wall_s);
  text += Line("recorded       {} rows, {} samples on {} topics, {} lost", m.rows, facts.samples, facts.topics,
               engine.lost);
  for (std::size_t k = 0; k < meter.phases().size(); ++k) text += PhaseText(experiment, meter, k, prediction);
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
  text += IncidentsText(experiment, incidents);
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
