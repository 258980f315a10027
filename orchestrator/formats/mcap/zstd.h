#pragma once

#include <cstddef>
#include <memory>

#include "orchestrator/formats/bytes.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace mascot::mcap {

/// zstd compression with a fixed level and one thread: equal input gives equal output.
class Compressor {
 public:
  Compressor();
  /// Returns the compressed bytes, valid until the next call; empty if they would not be fewer than `raw`.
  ByteSpan Compress(ByteSpan raw);

 private:
  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> context_;
  Bytes buffer_;
};

/// zstd decompression, block by block. Memory grows with the output, not with the size that the file claims.
class Decompressor {
 public:
  Decompressor();
  /// Returns the decompressed bytes, valid until the next call; only the whole blocks if `compressed` is cut off.
  /// Throws Malformed if the input is not zstd data or gives more than `claimed` bytes.
  ByteSpan Decompress(ByteSpan compressed, std::size_t claimed);

 private:
  std::unique_ptr<ZSTD_DCtx_s, std::size_t (*)(ZSTD_DCtx_s*)> context_;
  Bytes buffer_;
};

}  // namespace mascot::mcap
