#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "idl/topics.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/recorded_ticks.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Assembles rows from the samples of a recording. All samples of a tick have the same log time.
class RowAssembler {
 public:
  struct Wanted {
    std::string file;  ///< name of the recording, for error messages
    int agents = 0;
    int rate_hz = 0;                 ///< ticks per simulated second
    RecordedTicks ticks = {0, 1};    ///< those of the rows to assemble; later samples are ignored
    std::vector<int> commands = {};  ///< ids of the agents of which each row must have the command
  };
  RowAssembler(const Wanted& wanted, std::function<void(const Row&)> on_row);
  RowAssembler(const RowAssembler&) = delete;
  RowAssembler& operator=(const RowAssembler&) = delete;

  /// Declares that channel `id` carries samples of `topic`, an agent's state or command.
  void AddChannel(std::uint16_t id, const Topic& topic);
  /// Takes the next message of the file, of any channel. Passes a row to `on_row` when the next tick begins; throws
  /// std::runtime_error if the row lacks a sample.
  void Take(const McapContents::Message& message);
  /// Passes the last row to `on_row`, at the end of the file. Throws std::runtime_error if a row is missing.
  void Finish();

 private:
  [[noreturn]] void Fail(const std::string& what) const { throw std::runtime_error(wanted_.file + ": " + what); }
  bool IsDone() const { return next_ == wanted_.ticks.rows(); }
  void Begin();
  void HandOver();

  Wanted wanted_;
  std::function<void(const Row&)> on_row_;
  Row row_;
  std::int64_t next_ = 0;                        // the number of row_
  std::uint64_t time_ns_ = 0;                    // log time of row_
  std::map<std::uint16_t, Row::Bytes*> places_;  // where samples go in row_, by channel
};

}  // namespace mascot
