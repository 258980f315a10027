#pragma once

#include <cstdint>
#include <string>

#include "orchestrator/formats/bytes.h"

namespace mascot {

/// Makes the records of a zip archive of uncompressed entries, dated 1980-01-01, so that its bytes depend only on the
/// calls made. The caller writes them, and the entries.
class ZipRecords {
 public:
  /// Sizes and offsets of `zip64_from` bytes and more are written in zip64 form. Tests lower the limit.
  explicit ZipRecords(std::uint64_t zip64_from = 0xFFFFFFFF) : zip64_from_(zip64_from) {}
  /// Adds an entry of `size` bytes with CRC-32 `crc`. Returns its header, which belongs at `offset` in the file; the
  /// bytes of the entry follow it. The size of the header does not depend on `crc`.
  Bytes Add(const std::string& name, std::uint64_t offset, std::uint64_t size, std::uint32_t crc);
  /// What follows all entries, at `offset`: the central directory and its end.
  Bytes End(std::uint64_t offset);

 private:
  std::uint64_t zip64_from_;
  std::uint64_t entries_ = 0;
  Bytes directory_;  // the central directory so far
};

}  // namespace mascot
