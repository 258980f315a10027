#include "orchestrator/live/shown/view_sink.h"

#include <exception>
#include <string>

namespace mascot {
namespace {

/// What was thrown, in words.
std::string Thrown() {
  try {
    throw;
  } catch (const std::exception& failure) {
    return failure.what();
  } catch (...) {
    return "an exception of unknown type";
  }
}

}  // namespace

void ViewSink::Adopt(const LiveExperiment& live, std::span<const Event> events) {
  if (broken_) return;
  try {
    inner_.Adopt(live, events);
  } catch (...) {
    broken_ = true;
    fail_(Thrown());
  }
}

void ViewSink::Add(const FlownRow& row) {
  if (broken_) return;
  try {
    inner_.Add(row);
  } catch (...) {
    broken_ = true;
    fail_(Thrown());
  }
}

}  // namespace mascot
