// MCAP files that tests write record by record.
#pragma once

#include <zstd.h>

#include <cstdint>
#include <string>
#include <vector>

#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/writer.h"

namespace mascot {

constexpr std::uint64_t kMs = 1'000'000;

inline McapWriter::Channel Numbers(const std::string& topic) {
  return {topic, "test_msgs/msg/Number", "uint64 n\n", {{"a", "b"}}};
}

/// A file with magic and header, followed by `records`.
inline std::string Handmade(const Bytes& records) {
  Bytes file;
  Append(file, ByteSpan(mcap::kMagic));
  mcap::Record(file, mcap::Op::kHeader).String("ros2").String("hand").End();
  Append(file, ByteSpan(records));
  return {file.begin(), file.end()};
}

inline Bytes ChunkRecord(std::uint64_t claimed, const std::string& compression, ByteSpan stored) {
  Bytes out;
  mcap::Record record(out, mcap::Op::kChunk);
  record.U64(0).U64(0).U64(claimed).U32(0).String(compression).U64(stored.size()).Raw(stored).End();
  return out;
}

/// A damaged or malicious file, and what its reader says of it.
struct Hostile {
  std::string name;
  Bytes records;
  std::string damage;
};

inline std::vector<Hostile> HostileFiles() {
  Bytes zeros(1 << 20), zstd(1 << 20);
  zstd.resize(ZSTD_compress(zstd.data(), zstd.size(), zeros.data(), zeros.size(), 3));
  Bytes endless, unknown_channel, no_schema, stray(3), loose_footer;
  mcap::Record(endless, mcap::Op::kAttachment).U64(0).End(/*beyond=*/std::uint64_t{1} << 62);
  mcap::Record(unknown_channel, mcap::Op::kMessage).U16(7).U32(0).U64(0).U64(0).End();
  mcap::Record(no_schema, mcap::Op::kChannel).U16(1).U16(5).String("/n").String("cdr").Map({}).End();
  mcap::Record(loose_footer, mcap::Op::kFooter).U64(0).U64(0).U32(0).End();
  Bytes long_string;
  mcap::Record(long_string, mcap::Op::kMetadata).U32(0xFFFFFFFF).End();
  return {
      {"HugeClaim", ChunkRecord(std::uint64_t{1} << 62, "zstd", zstd),
       "a chunk of 4611686018427387904 bytes, above the limit of 67108864"},
      {"Bomb", ChunkRecord(1000, "zstd", zstd), "a chunk holds more than the 1000 bytes it claims"},
      {"ClaimsTooMuch", ChunkRecord(mcap::kMaxChunkBytes, "zstd", zstd), "a chunk holds 1048576 bytes, not 67108864"},
      {"NoZstd", ChunkRecord(10, "zstd", zeros), "zstd: Unknown frame descriptor"},
      {"UnknownCompression", ChunkRecord(10, "lz4", zeros), "unknown compression 'lz4'"},
      {"StoredTooShort", ChunkRecord(10, "", stray), "a chunk holds 3 bytes, not 10"},
      {"StrayBytes", ChunkRecord(3, "", stray), "a field runs past the end of its record"},
      {"EndlessRecord", endless, "the file ends inside a record"},
      {"LongString", long_string, "a field runs past the end of its record"},
      {"UnknownChannel", unknown_channel, "a message on the unknown channel 7"},
      {"UnknownSchema", no_schema, "channel /n has an unknown schema"},
      {"LooseFooter", loose_footer, "a footer without the end of the data section"},
  };
}

}  // namespace mascot
