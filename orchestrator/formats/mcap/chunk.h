#pragma once

#include <cstdint>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/zstd.h"

namespace mascot::mcap {

/// A chunk, decompressed.
struct Chunk {
  ByteSpan records;                ///< valid as long as the record's bytes, and until the decompressor's next call
  std::uint64_t stored_bytes = 0;  ///< size in the file, without the chunk's other fields
};

/// Opens the chunk record of this body. `whole`: all of the record is in the file; then size and CRC must be right.
/// The CRC of a chunk that is cut off cannot be compared, but cutting changes none of the bytes before the cut:
/// whatever can be decompressed is given. Throws Malformed.
Chunk OpenChunk(Fields body, bool whole, Decompressor& decompressor);

/// The next record of an open chunk: takes it off `records`. Throws Malformed where the chunk is cut off.
struct InnerRecord {
  std::uint8_t op = 0;
  Fields body;
};
InnerRecord TakeRecord(ByteSpan& records);

}  // namespace mascot::mcap
