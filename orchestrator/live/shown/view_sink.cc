#include "orchestrator/live/shown/view_sink.h"

#include "system/failure.h"

namespace mascot {

void ViewSink::Adopt(const LiveExperiment& live, std::span<const Event> events) {
  if (broken_) return;
  try {
    inner_.Adopt(live, events);
  } catch (...) {
    broken_ = true;
    fail_(CaughtInWords());
  }
}

void ViewSink::Add(const FlownRow& row) {
  if (broken_) return;
  try {
    inner_.Add(row);
  } catch (...) {
    broken_ = true;
    fail_(CaughtInWords());
  }
}

}  // namespace mascot
