#pragma once

#include <cstdint>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/zstd.h"

namespace mascot::mcap {

/// How much the chunks of a file may unpack to, all together. Rows of a run take a fifth to a fiftieth of their size;
/// zeros take a ten-thousandth, and a small file of them would keep its reader busy for hours.
class UnpackLimit {
 public:
  static constexpr std::uint64_t kFreeBytes = std::uint64_t{256} << 20;  ///< this much may be compressed by any factor
  /// And beyond it, at most this many times the stored size.
  static constexpr std::uint64_t kMaxTimes = 300;

  /// Counts one more chunk. Throws Malformed if all chunks together are too much.
  void Add(std::uint64_t stored_bytes, std::uint64_t bytes);

 private:
  std::uint64_t stored_bytes_ = 0, bytes_ = 0;
};

/// A chunk, decompressed.
struct Chunk {
  ByteSpan records;                ///< valid as long as the record's bytes, and until the decompressor's next call
  std::uint64_t stored_bytes = 0;  ///< size in the file, without the chunk's other fields
};

/// Opens the chunk record of this body. `whole`: all of the record is in the file; then size and CRC must be right.
/// The CRC of a chunk that is cut off cannot be compared, but cutting changes none of the bytes before the cut:
/// whatever can be decompressed is given. `limit` counts it before it is decompressed. Throws Malformed.
Chunk OpenChunk(Fields body, bool whole, Decompressor& decompressor, UnpackLimit& limit);

/// The next record of an open chunk: takes it off `records`. Throws Malformed where the chunk is cut off.
struct InnerRecord {
  std::uint8_t op = 0;
  Fields body;
};
InnerRecord TakeRecord(ByteSpan& records);

}  // namespace mascot::mcap
