#include "orchestrator/live/recorded/metric_reader.h"

#include <cstdint>
#include <exception>
#include <utility>

namespace mascot {

MetricReader::MetricReader(const std::string& run, MetricCurves& curves, std::function<void(const std::string&)> log)
    : rows_(run), curves_(curves), log_(std::move(log)) {
  thread_ = std::jthread([this](const std::stop_token& over) { Run(over); });
}

void MetricReader::Run(const std::stop_token& over) {
  DecodedRow row(rows_.agents());
  try {
    for (std::int64_t tick = 0; tick < rows_.ticks() && !over.stop_requested(); ++tick) {
      rows_.Read(tick, row);
      curves_.Add(tick, row);
    }
  } catch (const std::exception& error) {
    log_(std::string("warning: ") + error.what() + ": curves of metrics end there");
  }
}

}  // namespace mascot
