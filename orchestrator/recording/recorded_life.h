#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/wire.h"
#include "experiment/experiment.h"
#include "experiment/silences.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/raw_rows.h"

namespace mascot {

/// What one agent of a recorded run has heard and answered, tick by tick.
class RecordedLife {
 public:
  /// `contents` are those of `file`, `plan` is its plan, `experiment` says which agents are heard. Throws ConfigError,
  /// with the reason, if the recording does not hold all that the agent has heard.
  RecordedLife(const std::string& file, const McapContents& contents, const RecordingPlan& plan,
               const Experiment& experiment, int agent);

  struct Tick {
    const Row* row = nullptr;  ///< the samples of this tick, agents that are not heard included
    /// The messages that were sent with the answers to the tick before, by id - 1; empty: none.
    const std::vector<Row::Bytes>* messages = nullptr;
    bool begins = false;   ///< a fresh process of the agent, which answers from this tick on
    bool answers = false;  ///< the agent has answered this tick; else it was lost, or has missed it in real time
    bool is_lost = false;  ///< it was lost: it had no process any more
  };
  /// The next tick; nothing at the end of what is recorded. Valid until the next call. Throws std::runtime_error if a
  /// sample is missing on the way.
  std::optional<Tick> Next();

  /// All events before `tick`, as they were sent.
  std::vector<mascot_msgs::msg::Event> EventsBefore(std::int64_t tick) const;
  /// Ids of the agents whose states the agent gets: itself first.
  const std::vector<int>& sources() const { return sources_; }
  /// Whether the recording has the messages of the agent, which its law sends.
  bool has_messages() const { return has_messages_; }

 private:
  void Require(const Topic& topic, const std::string& why) const;
  void ReadEvents();
  bool Restarts(std::int64_t tick) const;
  /// What the row lacks of what the agent has heard and answered; empty: nothing.
  std::string Missing(const Tick& tick) const;

  const std::string file_;
  const RecordingPlan plan_;
  const Experiment& experiment_;
  const int agent_;
  std::vector<int> sources_, senders_;  // ids; of the sources, those that are heard and send messages
  bool has_messages_ = false;
  std::vector<mascot_msgs::msg::Event> events_;  // all
  std::vector<std::int64_t> restarts_;           // ticks at which an event restarts the agent
  Silences silences_;                            // as all events say
  RawRows rows_;
  std::vector<Row::Bytes> messages_, next_messages_;  // of the tick before, of this tick
  std::int64_t tick_ = -1;                            // of the newest row
  bool lives_ = false;
};

}  // namespace mascot
