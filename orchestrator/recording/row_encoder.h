#pragma once

#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/recording/decoded_row.h"
#include "orchestrator/recording/row.h"

namespace mascot {

/// Makes of what was flown in one process the bytes that processes would have sent each other.
class RowEncoder {
 public:
  explicit RowEncoder(const Experiment& experiment) : experiment_(experiment), row_(experiment.size()) {}
  /// Valid until the next call.
  const Row& Encode(std::int64_t tick, const DecodedRow& decoded);

 private:
  const Experiment& experiment_;
  Row row_;  // this and the samples are kept, so that nothing is allocated from tick to tick
  rosgraph_msgs::msg::Clock clock_;
  mascot_msgs::msg::AgentState state_;
  mascot_msgs::msg::AgentCommand command_;
  mascot_msgs::msg::AgentMessage message_;
};

}  // namespace mascot
