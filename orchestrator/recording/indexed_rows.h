#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "idl/topics.h"
#include "orchestrator/formats/mcap/index.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Reads rows of a recording in any order, by its index (formats/mcap/index.h): only the chunks that hold them. The row
/// of a tick depends on that tick alone, not on what was read before. Needs no other file of the run.
class IndexedRows {
 public:
  /// Throws ConfigError if `run` is not a recording of a run, and std::runtime_error as RowsIn().
  explicit IndexedRows(const std::string& run);

  const std::string& path() const { return path_; }
  /// The resolved experiment as TOML; name() is its run.name.
  const std::string& config() const { return contents_.attachments.at(kConfigFile); }
  const std::string& name() const { return rows_.plan.name; }
  int agents() const { return rows_.plan.agents; }
  bool has_commands() const { return rows_.has_commands; }
  /// The ticks of which it has complete rows.
  const RecordedTicks& ticks() const { return rows_.ticks; }
  /// Why later ticks may be missing (LossOf); empty: the recording was closed properly.
  std::string loss() const { return LossOf(contents_); }

  /// Reads the row of `tick`, or the newest before it (record.rate_hz); `tick` is at most the last of ticks(). A
  /// command that is missing in real time is the newest one of the second before; 0 if there is none. Throws
  /// std::runtime_error if a sample is missing or damaged.
  void Read(std::int64_t tick, DecodedRow& row);

  struct EventAt {
    std::int64_t tick = 0;
    int number = 0;
    std::string toml;  ///< Event::Toml()
  };
  /// All events up to the last complete row, in order; none if record.topics left them out. Reads the chunks that hold
  /// one.
  std::vector<EventAt> Events();

  /// How much of the file was read so far (McapIndex::bytes_read).
  std::uint64_t bytes_read() const { return index_->bytes_read(); }

 private:
  using Samples = std::vector<McapContents::Message>;
  /// A chunk that was read: its samples by time, those of one time in the order of the file.
  struct Loaded {
    std::size_t chunk = 0;
    Samples samples;
  };

  const Samples& Load(std::size_t chunk);
  void Collect(std::int64_t tick, Row& row);
  void HoldCommands(std::int64_t tick);
  void Require(const Row::Bytes& sample, const Topic& topic) const;

  std::string path_;
  std::unique_ptr<McapIndex> index_;
  McapContents contents_;
  RowsOf rows_;
  std::map<std::uint16_t, Topic> topics_;  // what the channels carry that rows have
  std::deque<Loaded> loaded_;              // the newest in front
  Row row_, before_;                       // reused
};

}  // namespace mascot
