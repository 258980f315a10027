#include "orchestrator/recording/row_assembler.h"

#include <utility>

#include "bus/wire.h"
#include "orchestrator/recording/row_codec.h"

namespace mascot {

RowAssembler::RowAssembler(const Wanted& wanted, std::function<void(const Row&)> on_row)
    : wanted_(wanted), on_row_(std::move(on_row)), row_(wanted.agents) {
  Begin();
}

void RowAssembler::AddChannel(std::uint16_t id, const Topic& topic) { places_[id] = &SampleOf(row_, topic); }

void RowAssembler::Take(const McapContents::Message& message) {
  const auto place = places_.find(message.channel);
  if (place == places_.end() || IsDone()) return;
  if (message.log_time != time_ns_) HandOver();
  if (IsDone()) return;
  if (message.log_time != time_ns_) Fail("tick " + std::to_string(row_.tick) + " is missing");
  *place->second = message.data;
}

void RowAssembler::Finish() {
  if (!IsDone()) HandOver();
  if (!IsDone()) Fail("tick " + std::to_string(row_.tick) + " is missing");
}

void RowAssembler::Begin() {
  row_.tick = wanted_.ticks.TickOf(next_);
  time_ns_ = StampNs(row_.tick, wanted_.rate_hz);
  for (Row::Bytes& state : row_.states) state.clear();
  for (Row::Bytes& command : row_.commands) command.clear();
}

void RowAssembler::HandOver() {
  auto require = [this](const Row::Bytes& sample, const Topic& topic) {
    if (sample.empty()) Fail("tick " + std::to_string(row_.tick) + " has no " + topic.Name());
  };
  for (int id = 1; id <= wanted_.agents; ++id) require(row_.states[static_cast<std::size_t>(id - 1)], Topic::State(id));
  for (const int id : wanted_.commands) require(row_.commands[static_cast<std::size_t>(id - 1)], Topic::Command(id));
  on_row_(row_);
  ++next_;
  Begin();
}

}  // namespace mascot
