// A run in the process of the test, measured and predicted as `up --engine inprocess` does, without files.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/report/incident_report.h"
#include "orchestrator/report/run_figures.h"
#include "orchestrator/report/summary.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

struct LawRun {
  /// Flies `toml` to its end.
  explicit LawRun(const std::string& toml)
      : experiment(LoadExperiment(Section::FromText(toml, "test.toml"), "test")),
        prediction(Predict(experiment)),
        meter(experiment) {
    const EngineResult result = RunInProcess(experiment, {&meter}, [] { return true; });
    EXPECT_EQ(result.failure, "");
    const FlownRun flown{.experiment = experiment,
                         .prediction = prediction,
                         .meter = meter,
                         .engine = result,
                         .engine_name = "inprocess"};
    const RunFigures run(flown);
    figures = run.all();
    summary = nlohmann::json::parse(SummaryJson(run, 0, 0));
    text = SummaryText(run, IncidentsOf(meter, result, {}));
  }
  /// A figure of the team's law, as measured; then, as predicted. Throws a JSON error if it is no number.
  double Measured(const std::string& figure) const { return Law()[figure].get<double>(); }
  double Predicted(const std::string& figure) const { return Law()["predicted"][figure].get<double>(); }
  /// What summary.json says of the team's law.
  const nlohmann::json& Law() const { return summary["laws"][experiment.law.name]; }

  Experiment experiment;
  Prediction prediction;
  RunMeter meter;
  Figures figures;  ///< must not make tables (functions): these would use the run's result, which is gone
  nlohmann::json summary;
  std::string text;
};

}  // namespace mascot
