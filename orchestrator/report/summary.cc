#include "orchestrator/report/summary.h"

#include <fmt/format.h>

#include <algorithm>

#include "orchestrator/recording/recorded_ticks.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/report/aim_report.h"
#include "orchestrator/report/incident_report.h"
#include "orchestrator/report/json.h"
#include "orchestrator/report/law_report.h"
#include "orchestrator/report/prediction_report.h"
#include "orchestrator/report/text_line.h"

namespace mascot {
namespace {

/// "; tilt limited in 12 %, rotors in 3 %", or empty if neither was.
std::string AlsoLimited(const Figures& figures) {
  const double tilt = figures.Known("control.tilt_limited_fraction");
  const double rotors = figures.Known("control.rotor_limited_fraction");
  if (tilt + rotors == 0) return "";
  return fmt::format("; tilt limited in {:.3g} %, rotors in {:.3g} %", 100 * tilt, 100 * rotors);
}

/// Text on how late commands and ticks of a run in real time were.
std::string PaceText(const Figures& figures) {
  const auto ms = [&](const char* name) {
    return 1e3 * figures.Known(std::string("realtime.tick_lateness_s.") + name);
  };
  return Line("late           {} commands came after their tick; the last one was held, at most {:.3g} s old",
              figures.Count("realtime.misses"), figures.Known("realtime.command_age_s.max")) +
         Line("ticks          {:.3g} ms after they were due in the median, 99 % within {:.3g} ms, all within {:.3g} ms",
              ms("p50"), ms("p99"), ms("max"));
}

/// Text on the distance of agents, and what law.safety has to do with it.
std::string SeparationText(const Prediction& prediction, const Figures& figures) {
  const auto min_m = figures.Number("safety.min_separation_m");
  const auto in_plane_m = figures.Number("safety.min_separation_along_axes_m");
  const auto collisions = figures.Number("safety.collisions");
  const auto filtered = figures.Number("safety.filtered_fraction");
  std::string text;
  if (min_m)
    text += Line("separation     {:.3f} m at least{}, {} collisions", *min_m,
                 in_plane_m == min_m ? "" : fmt::format(" ({:.3f} m in the plane)", *in_plane_m),
                 collisions ? fmt::format("{}", figures.Count("safety.collisions")) : "an unknown number of");
  if (prediction.safety) text += Line("  predicted    {}", SafetyText(*prediction.safety));
  if (const std::string broken = figures.Words("safety.condition_broken"); !broken.empty())
    text += Line("  but          the condition did not hold in this run: {}", broken);
  if (filtered)
    text += Line("filtered       {:.3g} % of commands by law.safety; {} ticks without a safe one", 100 * *filtered,
                 figures.Count("safety.infeasible_ticks"));
  return text;
}

/// What a phase has come to; with its begin and its law in front if it is one of several.
std::string PhaseText(const RunFigures& run, const PhaseFigures& phase) {
  std::string text;
  if (run.phases().size() > 1)
    text += Line("from {:<9} law {}", fmt::format("{:g} s", run.run().experiment.time_s(phase.meter->from())),
                 phase.experiment().law.name);
  text += AimText(phase.experiment(), phase.aim, *phase.prediction, phase.figures);
  text += LawsText(phase.experiment(), phase.laws, *phase.prediction);
  if (!phase.prediction->silent.empty()) text += "theory         silent, because " + phase.prediction->silent + "\n";
  return text;
}

/// Text on samples that did not arrive; empty: all have.
std::string LinksText(const Figures& figures) {
  const double sent = figures.Known("links.sent"), lost = figures.Known("links.lost");
  const double late = figures.Known("links.late");
  if (lost + late == 0) return "";
  return Line("links          {} samples sent, {:.2f} % lost, {:.2f} % overtaken", figures.Count("links.sent"),
              100.0 * lost / sent, 100.0 * late / sent);
}

/// Name of the ideal bodies that a run is compared with (docs/recording.md, fidelity).
std::string IdealBodies(const Experiment& experiment) {
  const auto by_velocity = std::ranges::count_if(
      experiment.agents, [](const AgentConfig& agent) { return agent.traits().driven_by == Wanted::kVelocity; });
  return by_velocity == 0                   ? "ideal double integrators"
         : by_velocity == experiment.size() ? "ideal single integrators"
                                            : "ideal single and double integrators";
}

/// Text on how far the run was from one of ideal bodies.
std::string FidelityText(const Experiment& experiment, const Figures& figures) {
  std::string text;
  if (const std::string failure = figures.Words("fidelity.failure"); !failure.empty())
    text += "fidelity       not measured, the law failed on " + IdealBodies(experiment) + ": " + failure + "\n";
  if (const std::string fault = figures.Words("fidelity.fault"); !fault.empty())
    text += "fidelity       not measured: there are no ideal bodies since " + fault + "\n";
  const auto rms_m = figures.Number("fidelity.rms_m");
  const double travelled_m = figures.Known("fidelity.travelled_m");
  constexpr double kSome_m = 0.05;  // less would be written as "0.0 m", and nothing is a share of that
  if (rms_m && travelled_m >= kSome_m)
    text += Line("fidelity       {:.4f} m rms from {}: {:.2f} % of {:.1f} m travelled", *rms_m, IdealBodies(experiment),
                 100 * *rms_m / travelled_m, travelled_m);
  else if (rms_m)
    text += Line("fidelity       {:.2g} m rms from {}, while agents travelled {:.2g} m", *rms_m,
                 IdealBodies(experiment), travelled_m);
  return text;
}

/// Text on how far vehicles were from ideal bodies, by phase of their flights.
std::string GapsText(const Measured& measured) {
  std::string text;
  int agent = 0;
  for (const Measured::Gap& gap : measured.gaps) {
    const std::string begin = gap.agent == agent ? "; " : fmt::format("\n{:<15}", fmt::format("vehicle {}", gap.agent));
    text += fmt::format("{}{}: {:.3f} m rms from its ideal body, {:.3f} m at most", begin,
                        kFlightPhases.Name(gap.phase), gap.from_ideal.rms_m, gap.from_ideal.max_m);
    agent = gap.agent;
  }
  return text.empty() ? "" : text.substr(1) + "\n";
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

std::string SummaryJson(const RunFigures& figures, std::optional<int> exit, double total_s) {
  Json json = WhoseSummary(figures.run().experiment, figures.run().engine_name);
  AddTo(json, figures.all());
  json["exit"] = OrNull(exit);
  json["total_s"] = total_s;
  return JsonText(json);
}

std::string SummaryText(const RunFigures& run, const Incidents& incidents) {
  if (run.rows() == 0) return "nothing was recorded\n";
  const Experiment& experiment = run.run().experiment;
  const Figures& figures = run.all();
  const double sim_s = figures.Known("sim_s"), wall_s = figures.Known("wall_s");
  std::string text;
  text += Line("simulated      {:.2f} s in {:.2f} s: {:.1f} x real time", sim_s, wall_s, sim_s / wall_s);
  text += Line("recorded       {} rows, {} samples on {} topics, {} lost",
               RecordedTicks(run.rows(), experiment.ticks_per_row()).rows(), figures.Count("samples.recorded"),
               figures.Count("samples.topics"), figures.Count("samples.lost"));
  for (const PhaseFigures& phase : run.phases()) text += PhaseText(run, phase);
  text += Line("saturated      {:.3g} % of commands{}", 100 * figures.Known("control.saturated_fraction"),
               AlsoLimited(figures));
  if (run.run().engine.pacing) text += PaceText(figures);
  text += SeparationText(run.run().prediction, figures);
  text += IncidentsText(experiment, incidents);
  text += LinksText(figures);
  text += FidelityText(experiment, figures);
  text += GapsText(run.run().meter.Result());
  return text;
}

}  // namespace mascot
