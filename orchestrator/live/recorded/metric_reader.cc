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
    const RecordedTicks& ticks = rows_.ticks();
    for (std::int64_t k = 0; k < ticks.rows() && !over.stop_requested(); ++k) {
      rows_.Read(ticks.TickOf(k), row);
      curves_.Add(ticks.TickOf(k), row);
    }
  } catch (const std::exception& error) {
    log_(std::string("warning: ") + error.what() + ": curves of metrics end there");
  }
}

}  // namespace mascot
