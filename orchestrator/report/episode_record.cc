#include "orchestrator/report/episode_record.h"

#include <filesystem>
#include <utility>

#include "orchestrator/control/run_requests.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/report/incident_report.h"
#include "orchestrator/report/run_figures.h"
#include "orchestrator/report/run_files.h"
#include "orchestrator/report/summary.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

struct EpisodeRecord::Running {
  Running(const Experiment& of, const RunFolder& folder)
      : experiment(of), prediction(Predict(of)), meter(of), files(of, folder, meter), requests(of, 0) {}

  const Experiment& experiment;
  Prediction prediction;
  RunMeter meter;
  RunFiles files;
  RunRequests requests;  // knows which events were given by hand
};

EpisodeRecord::EpisodeRecord(const std::optional<std::string>& out, const Experiment& experiment, bool force,
                             const RunFolder::Words& words, std::string engine)
    : folder_(std::in_place, out, experiment, force, words), path_(folder_->path()), engine_(std::move(engine)) {}

EpisodeRecord::~EpisodeRecord() = default;

std::vector<RowSink*> EpisodeRecord::Begin(const Experiment& experiment) {
  if (!folder_) return {};
  began_ = std::chrono::steady_clock::now();
  running_ = std::make_unique<Running>(experiment, *folder_);
  std::vector<RowSink*> sinks;
  running_->files.AddTo(sinks);
  sinks.push_back(&running_->requests);
  return sinks;
}

void EpisodeRecord::End(const EngineResult& result) {
  if (running_ == nullptr) return;
  std::unique_ptr<Running> run = std::move(running_);
  const std::vector<Event> by_hand = run->requests.by_hand();
  const Experiment flown = run->files.Complete(by_hand, result);
  if (!by_hand.empty()) run->prediction = Predict(flown);
  const FlownRun whole{.experiment = run->experiment,
                       .prediction = run->prediction,
                       .meter = run->meter,
                       .engine = result,
                       .engine_name = engine_,
                       .topics = run->files.topics(),
                       .samples = run->files.samples()};
  run->files.WriteTables(IncidentsOf(run->meter, result, run->requests.numbers_by_hand()));
  if (!run->experiment.output.save_data) std::filesystem::remove(folder_->File("states.npz"));
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - began_;
  folder_->Write("summary.json", SummaryJson(RunFigures(whole), result.failure.empty() ? 0 : 1, total.count()));
  run.reset();  // which uses the folder
  folder_.reset();
}

}  // namespace mascot
