#include "orchestrator/sweeping/sweep_work.h"

#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "agent/laws/laws.h"
#include "experiment/toml/input.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/recording/run_arrays.h"
#include "orchestrator/report/run_figures.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "orchestrator/sweeping/table/sweep_json.h"
#include "orchestrator/theory/draws.h"
#include "orchestrator/theory/theory.h"

namespace mascot {
namespace {

/// The metrics of the user's file.
const PythonMetrics& OwnMetrics(const Sweep& sweep) {
  if (!*sweep.own) sweep.own->emplace(sweep.metric_file);
  return **sweep.own;
}

/// Adds the cells of the user's metrics.
void AddOwn(const PythonMetrics& own, const RunArrays& arrays, std::map<std::string, std::string>& cells) {
  const std::vector<std::optional<double>> numbers = own.Of(arrays.All());
  for (std::size_t k = 0; k < numbers.size(); ++k)
    cells[own.list()[k].name] = numbers[k] ? ShortestFloat(*numbers[k]) : "";
}

/// Executes one run. Returns its cells by column. Throws ConfigError if the experiment is not valid, and
/// std::runtime_error if the run fails.
std::map<std::string, std::string> FlyOne(const Sweep& sweep, std::size_t run) {
  const Experiment experiment = sweep.Load(sweep.plan[run]);
  const Prediction prediction = Predict(experiment);
  RunMeter meter(experiment);
  RunArrays arrays(experiment);
  std::vector<RowSink*> sinks{&meter};
  if (sweep.own) sinks.push_back(&arrays);
  const EngineResult result = RunInProcess(experiment, sinks, [] { return true; });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  const FlownRun flown{.experiment = experiment, .prediction = prediction, .meter = meter, .engine = result};
  auto cells = SweepMetrics(RunFigures(flown).all());
  if (sweep.own) AddOwn(OwnMetrics(sweep), arrays, cells);
  return cells;
}

}  // namespace

Experiment Sweep::Load(const SweepPoint& point) const {
  Experiment experiment = LoadExperiment(text, name, laws.Fit(point.overrides));
  if (experiment.run.mode == Mode::kRealtime)
    throw ConfigError({"sweep: expected run.mode = \"lockstep\", got \"realtime\""});
  RefuseActions(experiment);
  return experiment;
}

WorkerPool::Work WorkOf(const Sweep& sweep) {
  return [sweep](std::size_t task) -> std::string {
    const SweepTasks tasks(sweep.plan);
    if (task < tasks.CheckOfRun(0)) return nlohmann::json(FlyOne(sweep, task)).dump();
    if (task == tasks.ListMetrics()) {
      nlohmann::json list = nlohmann::json::array();
      for (const PythonMetric& metric : OwnMetrics(sweep).list()) list.push_back(metric);
      return list.dump();
    }
    const bool of_run = task < tasks.CheckOfTrial(0);
    const Experiment experiment =
        sweep.Load(of_run ? sweep.plan[tasks.RunOfCheck(task)] : sweep.plan.Trial(task - tasks.CheckOfTrial(0)));
    const PythonNote python = NoteOfPython();
    return nlohmann::json({{"resolved", experiment.resolved},
                           {"draws", DrawsOf(experiment)},
                           {"laws", LawsAtTheEnd(experiment)},
                           {"python", {{"used", python.used}, {"warning", python.warning}}}})
        .dump();
  };
}

CheckedRun CheckedRunFrom(const std::string& answer) {
  const auto json = ReadJson<nlohmann::json>(answer);
  return {.resolved = json["resolved"],
          .draws = json["draws"],
          .laws = json["laws"].get<RunLaws>(),
          .python = {.used = json["python"]["used"], .warning = json["python"]["warning"]}};
}

std::vector<PythonMetric> MetricsFrom(const std::string& answer) {
  return ReadJson<nlohmann::json>(answer).get<std::vector<PythonMetric>>();
}

}  // namespace mascot
