#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "experiment/silences.h"
#include "idl/topics.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Assembles rows from the samples of all per-tick topics. Samples come in order on each topic, in any order between
/// topics. The sequence numbers of each writer prove that no sample is lost (CheckSequence). Agents that are lost, as
/// events say, send nothing.
///
/// Actions come from here: where agents take some, or somebody steps the run, a row waits until those of its tick are
/// taken (EndActions()). They are recorded with the answers to them alone.
///
/// Without DDS, clock or lock: Recorder passes in the samples and takes the rows.
class RowWindow {
 public:
  struct Rules {
    std::vector<Topic> topics;  ///< clock, states, commands, messages and actions, of the agents that have them
    int agents = 0;
    std::int64_t last_tick = 0;
    bool realtime = false;   ///< agents may miss ticks, so that a row may lack commands and messages
    std::int64_t ticks = 0;  ///< capacity in ticks, counted from the next row to write
    /// In real time: a row that lacks only commands or messages is ready when the newest tick is this far ahead.
    std::int64_t patience = 0;
    std::int64_t batch = 0;  ///< number of complete rows at which the writing thread is woken
    /// Agents may be lost at any tick, and what they have sent may have come here, but not to the server: the row of a
    /// tick is taken only with the states of the next one, which come after the event that says so.
    bool doubts = false;
    bool stepped = false;  ///< somebody steps the run
  };
  explicit RowWindow(Rules rules);

  const std::vector<Topic>& topics() const { return rules_.topics; }

  /// Notes that the sample of topic `index` that comes next has this sequence number of its writer, from 1. Throws
  /// std::runtime_error if an earlier sample of the topic is missing (but for commands and messages in real time), or
  /// if the sample came twice.
  void CheckSequence(std::size_t index, std::int64_t sequence);
  /// Takes a sample of topic `index` of the rules. Returns whether rows should be taken without delay. Throws
  /// std::runtime_error if its tick is too far ahead, or came before on this topic. For a state, `events` is the number
  /// of events that have taken effect up to its tick; the row of that tick is complete only with these events.
  bool Take(std::size_t index, std::int64_t tick, std::span<const std::uint8_t> bytes, std::int64_t events = 0);
  /// Takes event number `sequence`. Returns and throws as Take() does; throws also if it says that an agent has not
  /// answered a tick whose row, with its answer, was taken.
  bool TakeEvent(const Event& event, std::span<const std::uint8_t> bytes, std::int64_t sequence);
  /// The server has told its last tick: what has been answered until then has reached it.
  void Settle() { settled_ = true; }
  /// Whether an agent is lost for the time being, as the events so far say.
  bool IsLost(int agent) const { return silences_.Has(agent, rules_.last_tick); }
  /// Whether all states of `tick` have come, and the events that they speak of. Where rows wait for actions, they
  /// should be taken without delay then, and when one is complete.
  bool HasStates(std::int64_t tick) const;
  /// What has come of `tick`, if HasStates() is true of it.
  const Row& RowOf(std::int64_t tick) const { return slots_[PlaceOf(tick)].row; }
  /// All actions of `tick` have been taken.
  void EndActions(std::int64_t tick) { acted_ = tick; }
  /// Whether agents of the topic are lost at `tick`, as the events so far say.
  bool IsSilent(const Topic& topic, std::int64_t tick) const;
  /// Swaps the next row into `row` if it is complete; in real time also if it only lacks commands or messages and has
  /// waited `patience` ticks for them, or at all if `give_up`. Returns whether it did.
  bool Next(bool give_up, Row& row);

  /// The commands and messages that the next row lacks, although its tick has begun ("/agent_3/command of tick 50");
  /// empty: none.
  std::string Lacking() const;

  /// Number of rows taken so far; the next row has this tick.
  std::int64_t rows() const { return rows_; }
  /// Newest tick with a sample; -1 before the first sample.
  std::int64_t newest_tick() const { return newest_; }
  /// Number of samples that are known to be missing, or that came after their row was taken.
  std::uint64_t lost() const { return lost_; }

 private:
  /// A tick whose samples are being collected.
  struct Slot {
    std::int64_t tick = -1;
    std::size_t samples = 0;
    int states = 0;           // states and clock
    std::int64_t events = 0;  // up to this tick, as its states say
    Row row;
  };

  std::size_t PlaceOf(std::int64_t tick) const { return static_cast<std::size_t>(tick) % slots_.size(); }
  Slot& SlotOf(std::int64_t tick) { return slots_[PlaceOf(tick)]; }
  /// Clears `slot` for `tick`. Throws std::runtime_error if its row is not taken yet, or `tick` is too far ahead.
  void Begin(Slot& slot, std::int64_t tick) const;
  bool IsReady(const Slot& slot, bool give_up);
  /// Whether the slot has everything but what lost agents do not send.
  bool IsWhole(const Slot& slot) const;
  /// Leaves out what was sent and did not count.
  void LeaveOut(Slot& slot);
  /// Whether the slot waits for the answer of this topic.
  bool Lacks(const Slot& slot, const Topic& topic) const;

  const Rules rules_;
  const bool awaits_actions_;
  std::vector<Slot> slots_;
  std::vector<std::int64_t> sequences_;  // newest sequence number, by topic
  std::int64_t rows_ = 0;
  std::int64_t events_ = 0;  // in rows taken so far
  std::int64_t newest_event_ = 0;
  std::int64_t acted_ = -1;  // EndActions()
  Silences silences_;
  bool settled_ = false;
  std::size_t silent_ = 0;     // topics of agents that are lost now
  std::int64_t complete_ = 0;  // rows completed since the last Next()
  std::int64_t newest_ = -1;
  std::uint64_t lost_ = 0;
};

}  // namespace mascot
