#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// The bytes of a per-tick topic's sample in `row`.
Row::Bytes& SampleOf(Row& row, const Topic& topic);
const Row::Bytes& SampleOf(const Row& row, const Topic& topic);

/// Decodes `row` into `decoded`, which holds the previous row: a command that is missing in `row` keeps its value.
/// Throws std::runtime_error, with tick and topic, for bytes that are not a sample of the expected type.
void Decode(const Row& row, DecodedRow& decoded);

/// Decodes the states of `row`, by id - 1. Returns how many events have taken effect up to its tick. Throws as Decode()
/// does.
int DecodeStates(const Row& row, std::span<Motion> motions);

/// Decodes the action of agent `id` in `row`; empty: there is none. Throws as Decode() does.
void DecodeAction(const Row& row, int id, std::vector<double>& action);

/// Encodes the rows of a run in one process as the bytes that separate processes would have sent.
class RowEncoder {
 public:
  explicit RowEncoder(const Experiment& experiment) : experiment_(experiment), row_(experiment.size()) {}
  /// Encodes a row. The result is valid until the next call.
  const Row& Encode(std::int64_t tick, const DecodedRow& decoded);

 private:
  const Experiment& experiment_;
  Row row_;  // a member to avoid allocations in each tick
};

/// Sizes of single samples on the wire (bytes).
struct SampleSizes {
  std::uint64_t state = 0;
  std::uint64_t message = 0;  ///< without its numbers, of 8 bytes each
};
SampleSizes SizesOfSamples();

}  // namespace mascot
