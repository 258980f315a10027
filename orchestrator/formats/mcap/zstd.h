#pragma once

#include <cstddef>
#include <memory>

#include "orchestrator/formats/bytes.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace mascot::mcap {

/// zstd with a fixed level and one thread: equal input gives equal output.
class Compressor {
 public:
  Compressor();
  /// The compressed bytes, valid until the next call; empty if they would not be fewer.
  ByteSpan Compress(ByteSpan raw);

 private:
  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> context_;
  Bytes buffer_;
};

/// zstd, block by block: memory follows what comes out, not what the file claims.
class Decompressor {
 public:
  Decompressor();
  /// What is there of `compressed`, whole blocks only if it was cut; valid until the next call. Throws
  /// Malformed for what is no zstd and for more than `claimed` bytes.
  ByteSpan Decompress(ByteSpan compressed, std::size_t claimed);

 private:
  std::unique_ptr<ZSTD_DCtx_s, std::size_t (*)(ZSTD_DCtx_s*)> context_;
  Bytes buffer_;
};

}  // namespace mascot::mcap
