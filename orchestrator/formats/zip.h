#pragma once

#include <cstdint>
#include <string>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/output_file.h"

namespace mascot {

/// Writes a zip archive of uncompressed entries, dated 1980-01-01, so that its bytes depend only on the calls made.
/// Failures throw std::runtime_error.
class ZipWriter {
 public:
  /// Sizes and offsets of `zip64_from` bytes and more are written in zip64 form. Tests lower the limit.
  explicit ZipWriter(const std::string& path, std::uint64_t zip64_from = 0xFFFFFFFF);
  /// Begins an entry of `size` bytes with CRC-32 `crc`; the caller then passes exactly these bytes to Write.
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
