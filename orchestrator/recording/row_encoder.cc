#include "orchestrator/recording/row_encoder.h"

namespace mascot {

const Row& RowEncoder::Encode(std::int64_t tick, const DecodedRow& decoded) {
  const int rate = experiment_.control.rate_hz;
  row_.tick = tick;
  ToWire(tick, rate, clock_);
  Serialize(clock_, row_.clock);
  for (std::size_t i = 0; i < decoded.motions.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    ToWire(tick, rate, id, decoded.motions[i], state_);
    Serialize(state_, row_.states[i]);
    ToWire(tick, rate, id, decoded.commands[i], command_);
    Serialize(command_, row_.commands[i]);
    if (!experiment_.agents[i].sends_messages) continue;
    ToWire(tick, rate, id, decoded.messages[i], message_);
    Serialize(message_, row_.messages[i]);
  }
  return row_;
}

}  // namespace mascot
