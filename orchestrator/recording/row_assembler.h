#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "idl/topics.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Puts the samples of a recording together into rows: those of one tick have its log time.
class RowAssembler {
 public:
  struct Wanted {
    std::string file;  ///< for messages
    int agents = 0;
    int rate_hz = 0;             ///< of the ticks
    std::int64_t ticks = 0;      ///< rows that are whole; what follows is ignored
    bool every_command = false;  ///< whether a row without an agent's command is not whole
  };
  RowAssembler(const Wanted& wanted, std::function<void(const Row&)> on_row);
  RowAssembler(const RowAssembler&) = delete;
  RowAssembler& operator=(const RowAssembler&) = delete;

  /// The messages of channel `id` are samples of `topic`, an agent's state or command.
  void AddChannel(std::uint16_t id, const Topic& topic);
  /// The file's next message, of whatever channel. Hands a row to `on_row` when one is whole; throws
  /// std::runtime_error if one lacks a sample.
  void Take(const McapContents::Message& message);
  /// At the end of the file: the last row.
  void Finish();

 private:
  [[noreturn]] void Fail(const std::string& what) const { throw std::runtime_error(wanted_.file + ": " + what); }
  bool IsDone() const { return row_.tick == wanted_.ticks; }
  void Begin(std::int64_t tick);
  void HandOver();

  Wanted wanted_;
  std::function<void(const Row&)> on_row_;
  Row row_;
  std::uint64_t time_ns_ = 0;                    // of row_
  std::map<std::uint16_t, Row::Bytes*> places_;  // in row_, by channel
};

}  // namespace mascot
