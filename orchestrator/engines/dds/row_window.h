#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "idl/topics.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Makes rows of samples that come from every per-tick topic, in order on each, in any order between them. That nothing
/// is lost is proved by the sequence numbers of every writer.
///
/// It has no wire, clock or lock: Recorder brings the samples and takes the rows.
class RowWindow {
 public:
  struct Rules {
    std::vector<Topic> topics;  ///< clock, states, commands, and messages of the agents that send any
    int agents = 0;
    std::int64_t last_tick = 0;
    bool realtime = false;   ///< agents may miss ticks: rows need not have every command and message
    std::int64_t ticks = 0;  ///< that are held at most: what is not written and what comes may lie this far apart
    std::int64_t patience =
        0;  ///< in real time: a row is this much older than the newest before it goes without a command
    std::int64_t batch = 0;  ///< complete rows that are worth waking the writing thread for
  };
  explicit RowWindow(Rules rules);

  /// A sample of topic `index` of the rules. Returns whether rows should be taken without delay. Throws
  /// std::runtime_error if a sample before it is missing, if it came twice, or if its tick is too far ahead.
  bool Take(std::size_t index, std::int64_t tick, std::span<const std::uint8_t> bytes, std::int64_t sequence);
  /// Swaps the next row into `row`, if it is complete; in real time also if it has waited long enough for a command, or
  /// has waited at all if `give_up`. Returns whether it did.
  bool Next(bool give_up, Row& row);

  /// Rows handed out.
  std::int64_t rows() const { return rows_; }
  /// Newest tick of which a sample has come; -1 before the first.
  std::int64_t newest_tick() const { return newest_; }
  /// Samples that are known to be missing, or came when their row was gone.
  std::uint64_t lost() const { return lost_; }

 private:
  /// One tick that is coming in.
  struct Slot {
    std::int64_t tick = -1;
    std::size_t samples = 0;
    int states = 0;  // and the clock
    Row row;
  };

  void CheckSequence(std::size_t index, std::int64_t sequence);
  Slot& SlotOf(std::int64_t tick) { return slots_[static_cast<std::size_t>(tick) % slots_.size()]; }
  /// The slot of a tick that was not there yet.
  void Begin(Slot& slot, std::int64_t tick) const;
  bool IsReady(const Slot& slot, bool give_up) const;

  const Rules rules_;
  std::vector<Slot> slots_;
  std::vector<std::int64_t> sequences_;  // newest of each topic
  std::int64_t rows_ = 0;
  std::int64_t complete_ = 0;  // rows complete since rows were last taken
  std::int64_t newest_ = -1;
  std::uint64_t lost_ = 0;
};

}  // namespace mascot
