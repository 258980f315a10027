#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>

#include "orchestrator/team/row_sink.h"

namespace mascot {

/// A sink for viewers: if it throws, the view ends, and not the run, whose other sinks go on.
class ViewSink final : public RowSink {
 public:
  /// `fail` ends the view, and gets the reason.
  ViewSink(RowSink& inner, std::function<void(const std::string& why)> fail) : inner_(inner), fail_(std::move(fail)) {}
  void Adopt(const LiveExperiment& live, std::span<const Event> events) override;
  void Add(const FlownRow& row) override;
  void OnVehicle(const VehicleNews& news) override;

 private:
  void Try(const std::function<void()>& call);

  RowSink& inner_;
  const std::function<void(const std::string&)> fail_;
  bool broken_ = false;  // it gets no more rows
};

}  // namespace mascot
