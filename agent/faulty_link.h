#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/false_data.h"
#include "agent/link.h"
#include "base/random.h"
#include "experiment/faults.h"

namespace mascot {

/// What becomes of what an agent sends while its radio has a fault (FaultPart::kLink): the same for all that hear it.
/// Depends only on the seed, the agent, the ticks and what the agent sends from the fault on.
class FaultyLink {
 public:
  FaultyLink(const PartFault& fault, int rate_hz, std::uint64_t seed);

  std::int64_t since() const { return fault_.since; }
  /// By how much later than over a link in order what is sent arrives (s).
  double delay_s() const { return fault_.fault.kind == FaultKind::kDelayed ? fault_.fault.delay_s : 0; }
  /// Whether anything is sent at `tick`.
  bool Sends(std::int64_t tick) const;
  /// What is sent at `tick` (increasing) instead of `sample`. Valid until the next call, and as long as `sample`.
  Sample SentFor(std::int64_t tick, const Sample& sample);

 private:
  PartFault fault_;
  double rate_hz_;
  std::int64_t period_ticks_;
  Dice dice_;
  std::optional<FalseData> false_data_;
  bool is_kept_ = false;  // motion_ and message_ are those of the first sample
  Motion motion_;
  std::vector<double> message_;
};

}  // namespace mascot
