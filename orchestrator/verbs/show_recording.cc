#include "orchestrator/verbs/show_recording.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "orchestrator/live/recorded/metric_reader.h"
#include "orchestrator/live/recorded/playback.h"
#include "orchestrator/live/recorded/projector.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "orchestrator/live/shown/live_view.h"
#include "orchestrator/live/shown/metric_curves.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/verbs/viewers.h"
#include "system/interruptions.h"
#include "system/script.h"

namespace mascot {
namespace {

/// Returns the signal that ends the view; 0: an error of ours has.
int WaitForTheEnd(StopSignal& stop, const LiveView& view) {
  constexpr auto kLook = std::chrono::milliseconds(200);
  while (!view.has_failed())
    if (const int signal = stop.Within(kLook); signal != 0) return signal;
  return 0;
}

}  // namespace

int ShowRecording(const std::string& run, const Showing& showing, const std::string& words, StopSignal& stop,
                  Console& console) {
  const auto log = [&console](const std::string& line) { console.Line(line); };
  std::optional<EndsAtOnce> before_the_view(stop);
  RecordedRun recorded(run);
  if (!recorded.rows().loss().empty())
    console.Line("warning: " + recorded.rows().path() + ": " + recorded.rows().loss() + "; it plays up to there");
  const Prediction prediction = Predict(recorded.experiment());
  before_the_view.reset();
  Playback playback(recorded.experiment().control.rate_hz, recorded.rows().ticks());
  const LiveView::Options options{.address = showing.at.address,
                                  .port = showing.at.port,
                                  .allowed_origins = showing.allowed_origins,
                                  .page = FindShared("page", "orchestrator/live"),
                                  .results = std::filesystem::path(recorded.rows().path()).parent_path(),
                                  .source = {.recorded = recorded.part()},
                                  .pace = 1,
                                  .steering = showing.steering};
  const auto view = [&] {
    try {
      return std::make_unique<LiveView>(recorded.experiment(), prediction, playback, options, log);
    } catch (const std::runtime_error& failure) {
      throw ConfigError({words + ": " + failure.what()});
    }
  }();
  const Projector projector(recorded, playback, *view, log);
  std::optional<MetricCurves> metric_curves;
  std::optional<MetricReader> metric_reader;
  if (showing.metrics != nullptr) {
    metric_curves.emplace(
        recorded.experiment(), *showing.metrics, recorded.rows().ticks().rows() - 1, MetricCurves::Rows::kAllAtOnce,
        [&view](std::string message) { view->SetMetrics(std::move(message)); }, log);
    metric_reader.emplace(run, *metric_curves, log);
  }
  PrintAddresses(*view, console);
  return WaitForTheEnd(stop, *view);
}

}  // namespace mascot
