#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/dds/row_window.h"
#include "orchestrator/engines/row_feed.h"

namespace mascot {

/// Receives every per-tick topic as raw bytes, or the samples that the server sends in one (network.delivery), and
/// assembles rows (RowWindow). Samples arrive in DDS threads; rows go to the feed in the thread that calls Drain.
class Recorder {
 public:
  /// `stepped`: rows wait for EndActions(), also if no agent takes actions.
  Recorder(Domain& domain, const Experiment& experiment, RowFeed& feed, bool stepped = false);

  /// Whether every reader has matched a writer.
  bool Matched() const;
  /// Feeds complete rows, in tick order; in real time also rows that have waited long enough for missing commands, or,
  /// with `give_up`, that lack commands. Returns the number of rows fed since the start. Returns after 50 ms even if
  /// rows are left, and then wakes the loop to call it again. Throws what the feed throws.
  std::int64_t Drain(bool give_up = false);
  /// The events so far, in order, without the first `skip`.
  std::vector<mascot_msgs::msg::Event> Events(std::size_t skip = 0) const;
  /// Whether all states of `tick` have come, and the events that they speak of.
  bool HasStates(std::int64_t tick) const;
  /// Reads the states of `tick`, which have all come, by id - 1.
  void StatesOf(std::int64_t tick, std::span<Motion> motions) const;
  /// Records what agent `agent` is given at `tick`, of which all states have come. Returns false, and does not, if it
  /// is lost.
  bool TakeAction(int agent, std::int64_t tick, std::span<const std::uint8_t> bytes);
  /// All actions of `tick` have been taken: where agents take some, or somebody steps the run, its row waits for that.
  void EndActions(std::int64_t tick);
  /// The server has told its last tick (RowWindow::Settle()).
  void Settle();
  /// Whether all of these agents are lost, as the events so far say.
  bool AreLost(AgentRange agents) const;
  /// Samples that the next row waits for (RowWindow::Lacking()).
  std::string Lacking() const;
  /// Number of samples that are known to be missing, or that came too late for their row.
  std::uint64_t lost() const;
  /// Wall-clock time from the first sample to the newest command (s).
  double wall_s() const;
  /// When the first sample came.
  std::chrono::steady_clock::time_point started() const;
  /// Newest tick with a sample; -1 before the first sample.
  std::int64_t newest_tick() const;

 private:
  using Time = std::chrono::steady_clock::time_point;

  std::vector<std::size_t>& IndicesOf(TopicKind kind);
  void ListenToTopics();
  void ListenToRows();
  void OnEvent(const RawReader::Bytes& bytes, std::int64_t sequence);
  /// `index`: of the topic in the rules of window_.
  void OnSample(std::size_t index, const Topic& topic, const RawReader::Bytes& bytes, std::int64_t sequence);
  void OnRow(const RawReader::Bytes& bytes, std::int64_t sequence);
  /// Takes a sample without its encapsulation. Returns whether to wake the loop. Called with mutex_ held.
  bool TakeBody(std::size_t index, std::span<const std::uint8_t> body);
  /// Returns whether to wake the loop. Called with mutex_ held.
  bool Take(std::size_t index, std::int64_t tick, std::span<const std::uint8_t> bytes, std::int64_t events);
  /// Throws std::runtime_error unless the sample is of this topic's agent and of a tick of the run.
  std::int64_t TickOf(const Topic& topic, const RawReader::Bytes& bytes) const;

  Domain& domain_;
  const Experiment& experiment_;
  RowFeed& feed_;
  mutable std::mutex mutex_;  // guards window_, events_, started_ and last_command_
  RowWindow window_;
  std::vector<mascot_msgs::msg::Event> events_;
  Time started_{}, last_command_{};
  std::int64_t newest_row_ = 0;                                      // sequence number of the newest sample of /row
  RawReader::Bytes sample_;                                          // one of a row, with its encapsulation
  std::vector<std::size_t> states_, commands_, messages_, actions_;  // indices of topics, by id - 1; 0: none

  Row taken_;                                        // used only by the thread that calls Drain
  std::vector<std::unique_ptr<RawReader>> readers_;  // last: their callbacks use the members above
};

}  // namespace mascot
