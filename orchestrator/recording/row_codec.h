#pragma once

#include <cstdint>

#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// The place of a per-tick topic's sample in `row`.
Row::Bytes& SampleOf(Row& row, const Topic& topic);

/// Decodes `row` into `decoded`, which holds the row before: a command that was not sent stays as it is there. Throws
/// std::runtime_error for bytes that are no such sample.
void Decode(const Row& row, DecodedRow& decoded);

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

/// Bytes of single samples on the wire.
struct SampleSizes {
  std::uint64_t state = 0;
  std::uint64_t message = 0;  ///< without its numbers, of 8 bytes each
};
SampleSizes SizesOfSamples();

}  // namespace mascot
