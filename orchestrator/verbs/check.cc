// `orchestrator check CONFIG`: validates an experiment and prints what theory predicts. Starts nothing.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <utility>

#include "agent/laws/laws.h"
#include "agent/python/environment.h"
#include "experiment/agent_ids.h"
#include "experiment/processes.h"
#include "experiment/toml/input.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/recording/recorded_ticks.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/report/json.h"
#include "orchestrator/report/law_report.h"
#include "orchestrator/report/prediction_report.h"
#include "orchestrator/report/survival_report.h"
#include "orchestrator/theory/delays_in_effect.h"
#include "orchestrator/theory/draws.h"
#include "orchestrator/theory/graph_facts.h"
#include "orchestrator/theory/loss_tolerance.h"
#include "orchestrator/theory/survival.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/verbs/check_vehicles.h"
#include "orchestrator/verbs/config_args.h"
#include "orchestrator/verbs/law_trial.h"
#include "orchestrator/verbs/size_text.h"
#include "orchestrator/verbs/verb.h"
#include "system/interruptions.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

std::map<std::string, int> CountModels(const Experiment& experiment) {
  std::map<std::string, int> count;
  for (const AgentConfig& agent : experiment.agents) ++count[agent.model];
  return count;
}

Json ToJson(const GraphFacts& facts) {
  return {{"edges", facts.edges},           {"symmetric", facts.symmetric}, {"lambda_2", OrNull(facts.lambda_2)},
          {"components", facts.components}, {"roots", facts.roots},         {"tree_root", facts.tree_root},
          {"spanning_tree", facts.tree}};
}

/// The edges that certificates allow and that do not work at the start: the schedule brings them later.
std::vector<Edge> AllowedForLater(const Experiment& experiment) {
  std::vector<Edge> edges;
  for (int id = 1; id <= experiment.graph.size(); ++id)
    for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id))
      if (!experiment.schedule.At(0).Hears(id, heard.id)) edges.push_back({id, heard.id});
  return edges;
}

/// null without network.security.
Json SecurityJson(const Experiment& experiment) {
  if (!experiment.network.is_secure()) return nullptr;
  Json later = Json::array();
  for (const auto& [hearer, heard] : AllowedForLater(experiment)) later.push_back({hearer, heard});
  return {{"protection", kProtections.Name(experiment.network.protection)},
          {"edges", experiment.graph.edges()},
          {"edges_for_later", later}};
}

std::string SecurityText(const Experiment& experiment) {
  constexpr std::size_t kMost = 5;
  const std::vector<Edge> later = AllowedForLater(experiment);
  std::string text = fmt::format("certificates allow {} edges", experiment.graph.edges());
  if (later.empty()) return text;
  text += fmt::format(", {} of them for later: ", later.size());
  for (std::size_t k = 0; k < std::min(kMost, later.size()); ++k)
    text += fmt::format("{}{} hears {}", k == 0 ? "" : ", ", later[k].first, later[k].second);
  return later.size() > kMost ? text + fmt::format(" and {} more", later.size() - kMost) : text;
}

Json DelaysJson(const Experiment& experiment) {
  Json delays = Json::array();
  for (const DelayInEffect& delay : DelaysInEffect(experiment))
    delays.push_back({{"key", delay.key},
                      {"asked_s", delay.asked_s},
                      {"least_s", experiment.time_s(delay.min_ticks)},
                      {"most_s", experiment.time_s(delay.max_ticks)}});
  return delays;
}

std::vector<std::string> DelayLines(const Experiment& experiment) {
  std::vector<std::string> lines;
  for (const DelayInEffect& delay : DelaysInEffect(experiment)) {
    const bool jitters = delay.min_ticks != delay.max_ticks;
    lines.push_back(fmt::format("{} = {:g} s{} is {}{} ticks, {}{:g} s", delay.key, delay.asked_s,
                                delay.jitter_s > 0 ? fmt::format(" -+ {:g} s", delay.jitter_s) : "",
                                jitters ? fmt::format("{} to ", delay.min_ticks) : "", delay.max_ticks,
                                jitters ? fmt::format("{:g} to ", experiment.time_s(delay.min_ticks)) : "",
                                experiment.time_s(delay.max_ticks)));
  }
  return lines;
}

Json ObservationsJson(const Experiment& experiment) {
  Json observations = Json::array();
  for (const auto& [layout, ids] : PerceivedIn(experiment))
    observations.push_back({{"agents", ids},
                            {"layout", layout.Text()},
                            {"hash", layout.Hash()},
                            {"numbers", layout.size()},
                            {"names", layout.Names()}});
  return observations;
}

/// The phases after the first.
Json PhasesJson(const Experiment& experiment, const Prediction& prediction) {
  Json phases = Json::array();
  for (const LaterPhase& phase : prediction.later) {
    Json json = {{"at_s", experiment.time_s(phase.from)},
                 {"law", phase.experiment->law.name},
                 {"leader", phase.experiment->law.leader},
                 {"observations", ObservationsJson(*phase.experiment)},
                 {"predicted", PredictionJson(phase.prediction)}};
    AddPredictedFigures(*phase.experiment, phase.prediction, json);
    phases.push_back(std::move(json));
  }
  return phases;
}

/// About how large the large files of a run will be (bytes). What an agent and a row take in the recording, compressed,
/// was measured on the experiments in configs: 170 to 220 bytes for bodies with an airframe, 85 to 105 for others. In
/// types of ROS 2 it is 60 to 70 more, and for a second of /scene, with a trail, 2 to 5 KB.
struct FilesToCome {
  std::uint64_t states_npz = 0, recording = 0;
  std::uint64_t all() const { return states_npz + recording; }
};

FilesToCome FilesOf(const Experiment& experiment) {
  constexpr std::uint64_t kOfAirframe = 200, kOfOthers = 100, kOfRosTypes = 65, kOfScene = 4000;
  const auto rows =
      static_cast<std::uint64_t>(RecordedTicks(experiment.ticks() + 1, experiment.ticks_per_row()).rows());
  FilesToCome files;
  if (experiment.output.save_data)
    for (const StateArray& array : kStateArrays)
      files.states_npz += rows * experiment.agents.size() * array.components.size() * sizeof(double);
  if (experiment.record.topics.empty()) return files;
  for (const AgentConfig& agent : experiment.agents)
    files.recording += rows * (agent.traits().has_airframe ? kOfAirframe : kOfOthers);
  if (!experiment.record.ros_types) return files;
  const std::uint64_t scenes = std::min(rows, static_cast<std::uint64_t>(experiment.run.duration_s) + 1);
  files.recording += experiment.agents.size() * (rows * kOfRosTypes + scenes * kOfScene);
  return files;
}

Json ToJson(const Experiment& experiment, const GraphFacts& facts, const Prediction& prediction) {
  Json json = {{"experiment", experiment.run.name},
               {"duration_s", experiment.run.duration_s},
               {"ticks", experiment.ticks()},
               {"control_rate_hz", experiment.control.rate_hz},
               {"agents", experiment.size()},
               {"models", CountModels(experiment)},
               {"law", experiment.law.name},
               {"axes", kAxes.Name(experiment.law.axes)},
               {"leader", experiment.law.leader},
               {"observations", ObservationsJson(experiment)},
               {"graph", ToJson(facts)},
               {"security", SecurityJson(experiment)},
               {"draws", DrawsOf(experiment)},
               {"files_bytes", FilesOf(experiment).all()},
               {"delays", DelaysJson(experiment)},
               {"predicted", PredictionJson(prediction)},
               {"safety", SafetyPredictionJson(prediction)}};
  AddPredictedFigures(experiment, prediction, json);
  json["phases"] = PhasesJson(experiment, prediction);
  json["cannot_lose"] = LossToleranceJson(LossToleranceOf(experiment));
  json["survival"] = SurvivalJson(experiment, SurvivalOf(experiment));
  json["warnings"] = prediction.warnings;
  return json;
}

void PrintLine(std::string_view label, std::string_view text) {
  std::cout << fmt::format("  {:<14} {}\n", label, text);
}

std::string LawText(const LawConfig& law) {
  return fmt::format("{}, {}, axes {}", law.name, law.leader > 0 ? fmt::format("leader {}", law.leader) : "no leader",
                     kAxes.Name(law.axes));
}

void PrintObservations(const Experiment& phase) {
  for (const auto& [layout, ids] : PerceivedIn(phase))
    PrintLine("observation", fmt::format("{} numbers, hash {}, of agents {}: {}", layout.size(), layout.Hash(),
                                         IdRanges(ids), layout.Text()));
}

void PrintPredictions(const Experiment& phase, const Prediction& prediction) {
  for (const auto& [label, text] : PredictedFigureLines(phase, prediction)) PrintLine(label, text);
  for (const auto& [label, text] : PredictionLines(phase, prediction)) PrintLine(label, text);
}

std::string SeedText(const Experiment& experiment) {
  std::string keys;
  for (const std::string& key : DrawsOf(experiment)) keys += (keys.empty() ? "" : ", ") + key;
  return std::to_string(experiment.run.seed) +
         (keys.empty() ? ", without effect: nothing is drawn at random" : ", for " + keys);
}

/// Which keys make the files of a long run smaller is said where they are large.
std::string FilesText(const FilesToCome& files) {
  constexpr std::uint64_t kLarge = 100'000'000;
  if (files.all() == 0) return "none of the states (output.save_data, record.topics)";
  const bool both = files.states_npz > 0 && files.recording > 0;
  std::string text = "about " + SizeText(files.all());
  if (both) text += ": recording " + SizeText(files.recording) + ", states.npz " + SizeText(files.states_npz);
  if (files.all() < kLarge) return text;
  if (both) text += "; output.save_data = false leaves out the latter, which `export` makes of the recording";
  return text + "; record.rate_hz makes " + (both ? "both" : "it") + " smaller";
}

/// The corners of the box in which the agents start, in W.
std::pair<Eigen::Vector3d, Eigen::Vector3d> StartBox(const Experiment& experiment) {
  std::pair<Eigen::Vector3d, Eigen::Vector3d> box(experiment.agents.front().p_W, experiment.agents.front().p_W);
  for (const AgentConfig& agent : experiment.agents)
    box = {box.first.cwiseMin(agent.p_W), box.second.cwiseMax(agent.p_W)};
  return box;
}

std::string StartsText(const Experiment& experiment) {
  const auto [min_m, max_m] = StartBox(experiment);
  return fmt::format("x {:.1f} to {:.1f} m, y {:.1f} to {:.1f} m, z {:.1f} to {:.1f} m", min_m.x(), max_m.x(),
                     min_m.y(), max_m.y(), min_m.z(), max_m.z());
}

/// Says when agents should share processes: a tick over DDS costs about 10 us for each process, and 1 us for each
/// agent.
void PrintProcesses(const Experiment& experiment) {
  constexpr std::size_t kMany = 32;
  if (const std::size_t processes = AgentProcesses(experiment).size(); processes > kMany)
    PrintLine("processes",
              fmt::format("{} of agents over DDS; where agents share them (network.agents_per_process), the "
                          "same bytes fly faster",
                          processes));
}

void PrintExperiment(const Experiment& experiment) {
  std::string models;
  for (const auto& [model, count] : CountModels(experiment)) {
    models += fmt::format("{}{} {}", models.empty() ? "" : ", ", count, model);
  }
  PrintLine("experiment", experiment.run.name);
  PrintLine("agents", models);
  PrintLine("starts", StartsText(experiment));
  PrintProcesses(experiment);
  PrintLine("law", LawText(experiment.law));
  PrintObservations(experiment);
  PrintLine("duration", fmt::format("{:g} s, {} ticks at {} Hz", experiment.run.duration_s, experiment.ticks(),
                                    experiment.control.rate_hz));
  PrintLine("seed", SeedText(experiment));
  PrintLine("files", FilesText(FilesOf(experiment)));
  if (const PythonNote note = NoteOfPython(); !note.used.empty()) PrintLine("python", note.used);
}

/// Prints properties of the graph; for a schedule, of the union of its graphs.
void PrintGraph(const GraphFacts& facts, const Schedule& schedule) {
  const std::size_t graphs = schedule.phases().size();
  PrintLine("graph", fmt::format("{} edges, {}{}{}", facts.edges, facts.symmetric ? "symmetric" : "directed",
                                 graphs > 1 ? fmt::format(", in the union of {} graphs", graphs) : "",
                                 schedule.range_m() > 0 ? fmt::format(", within {:g} m", schedule.range_m()) : ""));
  if (facts.lambda_2) PrintLine("lambda_2", fmt::format("{:.6g}", *facts.lambda_2));
  PrintLine("components", fmt::format("{} strongly connected", facts.components.size()));
  PrintLine("roots", facts.roots.empty() ? "none: no spanning tree" : IdRanges(facts.roots));
}

int Check(ConfigArgs& args, bool json) {
  StopSignal stop;
  const EndsAtOnce at_once(stop);  // also while laws are tried
  Experiment experiment = args.Load();
  const GraphFacts facts = FactsOf(experiment.graph, experiment.law.leader);
  Prediction prediction = Predict(experiment);
  for (std::string& warning : DeliveryWarnings(experiment)) prediction.warnings.push_back(std::move(warning));
  if (PythonNote note = NoteOfPython(); !note.warning.empty()) prediction.warnings.push_back(std::move(note.warning));
  for (std::string& warning : TryLaws(experiment).warnings) prediction.warnings.push_back(std::move(warning));
  if (json) {
    std::cout << JsonText(ToJson(experiment, facts, prediction));
    return 0;
  }
  std::cout << NameOfInput(args.path) << ": valid\n";
  PrintExperiment(experiment);
  PrintGraph(facts, experiment.schedule);
  if (experiment.network.is_secure()) PrintLine("security", SecurityText(experiment));
  if (const auto tolerance = LossToleranceOf(experiment)) PrintLine("losses", tolerance->words);
  for (const std::string& line : DelayLines(experiment)) PrintLine("delay in use", line);
  PrintPredictions(experiment, prediction);
  for (const LaterPhase& phase : prediction.later) {
    PrintLine(fmt::format("from {:g} s", experiment.time_s(phase.from)), LawText(phase.experiment->law));
    PrintObservations(*phase.experiment);
    PrintPredictions(*phase.experiment, phase.prediction);
  }
  for (const auto& [label, text] : SurvivalLines(experiment, SurvivalOf(experiment))) PrintLine(label, text);
  for (const std::string& warning : prediction.warnings) std::cout << "warning: " << warning << "\n";
  return 0;
}

}  // namespace

std::function<int()> SetUpCheck(CLI::App& command) {
  const auto args = std::make_shared<ConfigArgs>();
  const auto json = std::make_shared<bool>(false);
  args->AddTo(command);
  const auto vehicles = std::make_shared<bool>(false);
  command.add_flag("--json", *json, "print JSON and nothing else");
  command.add_flag("--vehicles", *vehicles,
                   "listen to the vehicles, command nothing, and say who is there and what would be refused");
  return [args, json, vehicles] { return *vehicles ? CheckVehicles(args->Load(), *json) : Check(*args, *json); };
}

}  // namespace mascot
