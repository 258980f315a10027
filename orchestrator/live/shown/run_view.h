#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/live/shown/live_view.h"
#include "orchestrator/live/shown/shown_keys.h"
#include "orchestrator/live/shown/view_sink.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// The page of a run while it goes on: what happens in the run, how it is paced, and how it ended.
class RunView {
 public:
  /// Listens from now on, as LiveView does. All arguments but `options` must outlive this object, which is told by
  /// `requests` when the pace changes.
  RunView(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter, RunRequests& requests,
          const LiveView::Options& options, std::function<void(const std::string&)> log);
  ~RunView();
  RunView(const RunView&) = delete;
  RunView& operator=(const RunView&) = delete;

  LiveView& page() { return page_; }
  const LiveView& page() const { return page_; }
  /// Adds sinks that show the rows and the events of the run. The RunMeter and the RunRequests must be among `sinks`
  /// already: they know the figures, and which events were given by hand.
  void AddTo(std::vector<RowSink*>& sinks);
  /// Adds a further sink for viewers.
  void Add(RowSink& sink, std::vector<RowSink*>& sinks);
  /// Shows how the run ended.
  void SayHowItEnded(const EngineResult& result);

 private:
  /// Tells viewers of the events that rows bring.
  class Events final : public RowSink {
   public:
    Events(LiveView& page, const RunRequests& requests) : page_(page), requests_(requests) {}
    void Adopt(const LiveExperiment& live, std::span<const Event> events) override;
    void Add(const FlownRow& row) override;

   private:
    LiveView& page_;
    const RunRequests& requests_;
    std::shared_ptr<const Experiment> now_;
    std::vector<ShownKey> keys_;
  };

  RunRequests& requests_;
  LiveView page_;
  Events events_;
  std::vector<std::unique_ptr<ViewSink>> sinks_;
};

}  // namespace mascot
