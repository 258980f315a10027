#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "idl/topics.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Reads the rows of a recording in order, as the bytes that were sent, whichever topics it has: a sample that it has
/// not is empty. Holds one row at a time.
class RawRows {
 public:
  /// Throws std::runtime_error if the file cannot be read.
  RawRows(const std::string& path, int agents, int rate_hz);

  /// The next tick of which the recording has a sample; null at its end, or at the first damage. Valid until the next
  /// call. Throws std::runtime_error if a sample has the time of no tick.
  const Row* Next();
  /// Whether a row follows.
  bool HasMore() const { return next_ != nullptr; }

 private:
  void Clear();
  std::int64_t TickOf(const McapContents::Message& sample) const;
  void Take(const McapContents::Message& sample);

  const std::string path_;
  const int rate_hz_;
  McapReader reader_;
  Row row_;
  const McapContents::Message* next_ = nullptr;  // the first sample of the row after row_
};

}  // namespace mascot
