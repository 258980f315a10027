#include "orchestrator/report/run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "agent/laws/laws.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/report/aim_report.h"
#include "orchestrator/report/incident_report.h"
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

/// The edges of all phases of the graph together and, if it switches, those of each phase.
Json GraphJson(const Experiment& experiment) {
  Json graph = {{"edges", EdgesOf(experiment.graph)}};
  if (experiment.schedule.phases().size() == 1) return graph;
  graph["schedule"] = Json::array();
  for (const Schedule::Phase& phase : experiment.schedule.phases())
    graph["schedule"].push_back({{"at_s", phase.at_s}, {"edges", EdgesOf(phase.graph)}});
  return graph;
}

/// The first contacts, each with its time (s), the agent, what it touched and how fast (m/s).
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

std::int64_t Whole(std::uint64_t count) { return static_cast<std::int64_t>(count); }

void AddSafety(const FlownRun& run, const Measured& measured, Figures& figures) {
  const auto& contacts = run.engine.contacts;
  figures.Add("safety.min_separation_m", measured.min_separation_m);
  figures.Add("safety.min_separation_along_axes_m", measured.min_separation_along_axes_m);
  figures.Add("safety.collisions", contacts ? FigureValue(contacts->total()) : FigureValue());
  if (contacts) {
    figures.Add("safety.contacts.agents", contacts->agents);
    figures.Add("safety.contacts.ground", contacts->ground);
    figures.Add("safety.contacts.obstacles", contacts->obstacles);
    figures.Add("safety.contacts.first", [&run] { return FirstContacts(run.experiment, *run.engine.contacts); });
  } else {
    figures.Add("safety.contacts", FigureValue());
  }
  figures.Add("safety.filtered_fraction", measured.filtered_fraction);
  figures.Add("safety.infeasible_ticks", measured.infeasible_ticks);
  if (run.prediction.safety)
    AddSafetyPrediction(*run.prediction.safety, "safety.predicted.", figures);
  else
    figures.Add("safety.predicted", FigureValue());
  figures.AddWords("safety.condition_broken", BrokenCondition(measured, run.prediction));
}

/// Bytes of the samples sent over an edge: states and messages, as on the wire.
std::uint64_t BytesOf(const EdgeTraffic& edge, const SampleSizes& sizes) {
  return edge.count.sent * (sizes.state + (edge.sends_messages ? sizes.message : 0)) +
         sizeof(double) * edge.count.numbers;
}

Json EdgesJson(const std::vector<EdgeTraffic>& traffic) {
  const SampleSizes sizes = SizesOfSamples();
  Json edges = Json::array();
  for (const EdgeTraffic& edge : traffic)
    edges.push_back({{"hearer", edge.hearer},
                     {"heard", edge.heard},
                     {"sent", edge.count.sent},
                     {"lost", edge.count.lost},
                     {"late", edge.count.late},
                     {"bytes", BytesOf(edge, sizes)}});
  return edges;
}

void AddLinks(const RunMeter& meter, Figures& figures) {
  const SampleSizes sizes = SizesOfSamples();
  EdgeCount all;
  std::uint64_t bytes = 0;
  for (const EdgeTraffic& edge : meter.Traffic()) {
    all.sent += edge.count.sent;
    all.lost += edge.count.lost;
    all.late += edge.count.late;
    bytes += BytesOf(edge, sizes);
  }
  figures.Add("links.sent", Whole(all.sent));
  figures.Add("links.lost", Whole(all.lost));
  figures.Add("links.late", Whole(all.late));
  figures.Add("links.bytes", Whole(bytes));
  figures.Add("links.edges", [&meter] { return EdgesJson(meter.Traffic()); });
}

Json ToJson(const LawCurve& curve) {
  return {{"name", curve.name},
          {"unit", curve.unit},
          {"meaning", curve.meaning},
          {"decays", curve.decays},
          {"figure", curve.figure}};
}

/// What the pictures of a law need to know of it.
Json DrawingJson(const LawEntry& law) {
  const Drawing& drawing = law.drawing;
  return {{"leader", drawing.leader},
          {"switches", drawing.switches},
          {"pictures", std::vector<std::string_view>(drawing.pictures.begin(), drawing.pictures.end())},
          {"telling", drawing.telling},
          {"hull", drawing.hull.key},
          {"cells", drawing.cells.key},
          {"curve", law.curve ? ToJson(*law.curve) : Json()}};
}

/// What each phase has come to. `phases`: as long as it is.
Json PhasesJson(const Experiment& experiment, const std::vector<PhaseFigures>& phases) {
  Json list = Json::array();
  for (const PhaseFigures& phase : phases) {
    Json json = {{"at_s", experiment.time_s(phase.meter->from())},
                 {"law", phase.experiment().law.name},
                 {"drawing", DrawingJson(EntryOf(phase.experiment().law))}};
    AddTo(json, phase.figures);
    list.push_back(std::move(json));
  }
  return list;
}

void AddFidelity(const Measured& measured, Figures& figures) {
  const auto& fidelity = measured.fidelity;
  figures.Add("fidelity.rms_m", fidelity ? FigureValue(fidelity->rms_m) : FigureValue());
  figures.Add("fidelity.max_m", fidelity ? FigureValue(fidelity->max_m) : FigureValue());
  figures.Add("fidelity.travelled_m", measured.travelled_m);
  figures.AddWords("fidelity.failure", measured.fidelity_failure);
  figures.AddWords("fidelity.fault", measured.fidelity_fault);
}

/// What is known of agents with vehicles beside the others.
Json VehiclesJson(const Experiment& experiment, const std::vector<Measured::Gap>& gaps) {
  Json list = Json::array();
  for (const int agent : AgentsWithVehicles(experiment)) {
    Json phases = Json::object();
    for (const Measured::Gap& gap : gaps)
      if (gap.agent == agent)
        phases[kFlightPhases.Name(gap.phase)] = {
            {"rms_m", gap.from_ideal.rms_m}, {"max_m", gap.from_ideal.max_m}, {"s", experiment.time_s(gap.rows)}};
    list.push_back({{"agent", agent},
                    {"kind", kVehicleKinds.Name(experiment.agent(agent).vehicle->kind)},
                    {"gap", std::move(phases)}});
  }
  return list;
}

void AddRealtime(const std::optional<Pacing>& pacing, Figures& figures) {
  if (!pacing) return figures.Add("realtime", FigureValue());
  figures.Add("realtime.misses", Whole(pacing->misses));
  const auto add = [&](const std::string& name, const Pacing::Spread& spread) {
    figures.Add(name + ".p50", spread[0]);
    figures.Add(name + ".p99", spread[1]);
    figures.Add(name + ".max", spread[2]);
  };
  add("realtime.tick_lateness_s", pacing->tick_lateness_s);
  add("realtime.command_age_s", pacing->command_age_s);
}

PhaseFigures FiguresOfPhase(const FlownRun& run, std::size_t k) {
  const PhaseMeter& meter = run.meter.phases()[k];
  PhaseFigures phase{
      .meter = &meter, .prediction = &PredictionOf(run.prediction, k), .aim = meter.aim(), .laws = run.meter.LawsOf(k)};
  AddAim(meter.experiment(), phase.aim, *phase.prediction, phase.figures);
  AddLaws(meter.experiment(), phase.laws, *phase.prediction, phase.figures);
  return phase;
}

}  // namespace

RunFigures::RunFigures(const FlownRun& run) : run_(run) {
  for (std::size_t k = 0; k < run.meter.phases().size(); ++k) phases_.push_back(FiguresOfPhase(run, k));
  const Measured measured = run.meter.Result();
  const double wall_s = run.engine.wall_s;
  const std::int64_t ticks = std::max<std::int64_t>(measured.rows - 1, 0);  // periods flown: rows are 0 .. ticks
  const double sim_s = run.experiment.time_s(ticks);
  rows_ = measured.rows;
  all_.Add("ticks", ticks);
  all_.Add("sim_s", sim_s);
  all_.Add("wall_s", wall_s);
  all_.Add("real_time_factor", wall_s > 0 ? FigureValue(sim_s / wall_s) : FigureValue());
  all_.Add("ticks_per_s", wall_s > 0 ? FigureValue(static_cast<double>(ticks) / wall_s) : FigureValue());
  all_.Add("exit", FigureValue());
  all_.AddWords("failure", run.engine.failure);
  all_.Add("samples.topics", Whole(run.topics));
  all_.Add("samples.recorded", Whole(run.samples));
  all_.Add("samples.lost", Whole(run.engine.lost));
  all_.Add("wire.matches_graph", run.engine.wire_matches_graph);
  all_.Add("graph", [&run = run_] { return GraphJson(run.experiment); });
  all_.Add("drawing", [&last = phases_.back()] { return DrawingJson(EntryOf(last.experiment().law)); });
  all_.Add(phases_.back().figures);
  if (phases_.size() > 1) all_.Add("phases", [this] { return PhasesJson(run_.experiment, phases_); });
  all_.Add("control.effort", measured.effort_m2_per_s3);
  all_.Add("control.saturated_fraction", measured.saturated_fraction);
  all_.Add("control.tilt_limited_fraction", measured.tilt_limited_fraction);
  all_.Add("control.rotor_limited_fraction", measured.rotor_limited_fraction);
  AddSafety(run_, measured, all_);
  AddLinks(run_.meter, all_);
  AddFidelity(measured, all_);
  if (!AgentsWithVehicles(run.experiment).empty())
    all_.Add("vehicles",
             [&experiment = run_.experiment, gaps = measured.gaps] { return VehiclesJson(experiment, gaps); });
  if (run.experiment.run.mode == Mode::kRealtime) AddRealtime(run.engine.pacing, all_);
  all_.Add("startup_s", run.engine.startup_s);
  all_.Add("total_s", FigureValue());
}

}  // namespace mascot
