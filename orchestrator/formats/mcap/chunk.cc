#include "orchestrator/formats/mcap/chunk.h"

#include <string>

namespace mascot::mcap {

void UnpackLimit::Add(std::uint64_t stored_bytes, std::uint64_t bytes) {
  stored_bytes_ += stored_bytes;
  bytes_ += bytes;
  if (bytes_ <= kFreeBytes + kMaxTimes * stored_bytes_) return;
  throw Malformed("its chunks up to here unpack to " + std::to_string(bytes_) + " bytes, above the limit of " +
                  std::to_string(kFreeBytes) + " and " + std::to_string(kMaxTimes) + " times the " +
                  std::to_string(stored_bytes_) + " that they take");
}

Chunk OpenChunk(Fields body, bool whole, Decompressor& decompressor, UnpackLimit& limit) {
  body.U64();  // start time
  body.U64();  // end time
  const std::uint64_t size = body.U64();
  const std::uint32_t crc = body.U32();
  const std::string compression = body.String();
  const std::uint64_t stored_size = body.U64();
  const ByteSpan stored = whole ? body.Raw(stored_size) : body.rest();
  if (size > kMaxChunkBytes)
    throw Malformed("a chunk of " + std::to_string(size) + " bytes, above the limit of " +
                    std::to_string(kMaxChunkBytes));
  if (!compression.empty() && compression != "zstd") throw Malformed("unknown compression '" + compression + "'");

  if (!compression.empty()) limit.Add(stored.size(), size);
  const ByteSpan raw = compression.empty() ? stored : decompressor.Decompress(stored, static_cast<std::size_t>(size));
  if (whole) {
    if (raw.size() != size)
      throw Malformed("a chunk holds " + std::to_string(raw.size()) + " bytes, not " + std::to_string(size));
    if (crc != 0 && crc != Crc32(0, raw)) throw Malformed("the CRC of a chunk is wrong");
  }
  return {raw, stored.size()};
}

InnerRecord TakeRecord(ByteSpan& records) {
  Fields frame(records);
  const std::uint8_t op = frame.U8();
  const std::uint64_t length = frame.U64();
  const Fields body(frame.Raw(length));
  records = frame.rest();
  return {op, body};
}

}  // namespace mascot::mcap
