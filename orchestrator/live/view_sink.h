#pragma once

#include <span>

#include "orchestrator/live/live_view.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// A sink for viewers: what it throws ends the view, and not the run, whose other sinks go on.
class ViewSink final : public RowSink {
 public:
  ViewSink(RowSink& inner, LiveView& view) : inner_(inner), view_(view) {}
  void Adopt(const LiveExperiment& live, std::span<const Event> events) override;
  void Add(const FlownRow& row) override;

 private:
  RowSink& inner_;
  LiveView& view_;
  bool broken_ = false;  // it gets no more rows
};

}  // namespace mascot
