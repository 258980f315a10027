#pragma once

#include <cstdint>
#include <string>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/output_file.h"

namespace mascot {

/// Writes a zip archive of uncompressed entries, dated 1980-01-01: the bytes depend only on the calls made.
/// Failures throw std::runtime_error.
class ZipWriter {
 public:
  /// Entries, offsets and sizes of `zip64_from` bytes and more are written the zip64 way. A test lowers it.
  explicit ZipWriter(const std::string& path, std::uint64_t zip64_from = 0xFFFFFFFF);
  /// Begins an entry whose `size` bytes, with CRC-32 `crc`, are then given to Write.
  void Begin(const std::string& name, std::uint64_t size, std::uint32_t crc);
  void Write(ByteSpan bytes) { file_.Write(bytes); }
  void Close();

 private:
  OutputFile file_;
  std::uint64_t zip64_from_;
  std::uint64_t entries_ = 0;
  Bytes directory_;  // the central directory so far
};

}  // namespace mascot
