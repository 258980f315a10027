#include "orchestrator/live/shown/episode_view.h"

#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include "experiment/toml/section.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/tick_requests.h"
#include "orchestrator/live/shown/run_view.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/theory/theory.h"
#include "system/script.h"

namespace mascot {

/// One episode on the page, until the next begins.
struct EpisodeView::Shown {
  Shown(const Experiment& of, const Options& options)
      : experiment(of),
        prediction(Predict(experiment)),
        meter(experiment),
        requests(experiment, experiment.run.pace.value_or(options.pace)),
        view(experiment, prediction, meter, requests,
             {.address = options.at.address,
              .port = options.at.port,
              .page = FindShared("page", "orchestrator/live"),
              .source = {.engine = kInProcess},
              .pace = requests.status().pace,
              .goodbye = std::chrono::milliseconds(100)},  // whoever steps waits for it
             options.log) {}
  ~Shown() { requests.Close(); }  // nobody waits for an answer while the view ends
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  const Experiment experiment;  // lives longer than the episode
  const Prediction prediction;
  RunMeter meter;
  RunRequests requests;
  RunView view;
  std::optional<TickRequests> asked;  // absent before the first row, and after the last
  bool has_begun = false;
};

EpisodeView::EpisodeView(const Experiment& experiment, Options options) try : options_(std::move(options)) {
  RunRequests::CheckPace(options_.pace);
  Show(experiment);
} catch (const std::runtime_error& failure) {
  throw ConfigError({std::string("at: ") + failure.what()});
}

EpisodeView::~EpisodeView() = default;

void EpisodeView::Show(const Experiment& experiment) {
  shown_.reset();  // it has the port
  shown_ = std::make_unique<Shown>(experiment, options_);
  const LiveView& page = shown_->view.page();
  url_ = page.addresses().front();
  options_.at.port = page.port();  // that of the next episodes, too
}

std::vector<RowSink*> EpisodeView::Begin(const Experiment& experiment) try {
  if (shown_ == nullptr) return {};
  if (shown_->has_begun || experiment.resolved != shown_->experiment.resolved) {
    options_.pace = shown_->requests.status().pace;
    const std::string before = url_;
    Show(experiment);
    if (url_ != before) options_.log("the page is at " + url_ + " now");
  }
  shown_->has_begun = true;
  std::vector<RowSink*> sinks{&shown_->meter, &shown_->requests};
  shown_->view.AddTo(sinks);
  return sinks;
} catch (const std::runtime_error& failure) {
  options_.log(std::string("the view has ended: ") + failure.what());
  return {};
}

bool EpisodeView::Await(Episodes& episodes) {
  if (!shown_->asked)
    shown_->asked.emplace(shown_->experiment, shown_->requests, [&](const Event& event) { episodes.Take(event); });
  const auto may_wait = [&] { return !episodes.is_restoring() && options_.may_wait(); };
  return shown_->asked->Await(episodes.tick() + 1, episodes.new_pace(), may_wait) != TickRequests::Next::kStop;
}

void EpisodeView::End(const EngineResult& result) {
  shown_->asked.reset();
  shown_->view.SayHowItEnded(result);
}

}  // namespace mascot
