#include "orchestrator/live/shown/view_sink.h"

#include "system/failure.h"

namespace mascot {

void ViewSink::Try(const std::function<void()>& call) {
  if (broken_) return;
  try {
    call();
  } catch (...) {
    broken_ = true;
    fail_(CaughtInWords());
  }
}

void ViewSink::Adopt(const LiveExperiment& live, std::span<const Event> events) {
  Try([&] { inner_.Adopt(live, events); });
}

void ViewSink::Add(const FlownRow& row) {
  Try([&] { inner_.Add(row); });
}

void ViewSink::OnVehicle(const VehicleNews& news) {
  Try([&] { inner_.OnVehicle(news); });
}

}  // namespace mascot
