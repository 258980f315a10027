#include "orchestrator/formats/zip.h"

#include <algorithm>

namespace mascot {
namespace {

// PKWARE's APPNOTE.TXT, sections 4.3.7 (local header), 4.3.12 (central directory), 4.3.14-16 (its end),
// 4.5.3 (zip64 extra field).
constexpr std::uint32_t kLocalHeader = 0x04034b50;
constexpr std::uint32_t kDirectoryHeader = 0x02014b50;
constexpr std::uint32_t kZip64End = 0x06064b50;
constexpr std::uint32_t kZip64Locator = 0x07064b50;
constexpr std::uint32_t kEnd = 0x06054b50;
constexpr std::uint16_t kZip64Extra = 0x0001;
constexpr std::uint16_t kVersion = 20, kVersionZip64 = 45;
constexpr std::uint32_t kDate1980 = 0x21u << 16;  // 1 January 1980, 00:00, as date << 16 | time
constexpr std::uint32_t kSeeZip64 = 0xFFFFFFFF;
constexpr std::uint16_t kSeeZip64Count = 0xFFFF;

std::uint32_t Low(std::uint64_t value, bool zip64) { return zip64 ? kSeeZip64 : static_cast<std::uint32_t>(value); }

/// Appends the fields that local header and central directory have in common, from "version needed" to "extra field
/// length".
void AppendEntry(Bytes& out, const std::string& name, std::uint64_t size, std::uint32_t crc, bool zip64,
                 std::size_t extra_bytes) {
  Append(out, zip64 ? kVersionZip64 : kVersion);
  Append(out, std::uint32_t{0});  // flags; method: stored
  Append(out, kDate1980);
  Append(out, crc);
  Append(out, Low(size, zip64));  // compressed size
  Append(out, Low(size, zip64));  // uncompressed size
  Append(out, static_cast<std::uint16_t>(name.size()));
  Append(out, static_cast<std::uint16_t>(extra_bytes));
}

Bytes Zip64Extra(std::initializer_list<std::uint64_t> values) {
  Bytes extra;
  Append(extra, kZip64Extra);
  Append(extra, static_cast<std::uint16_t>(values.size() * sizeof(std::uint64_t)));
  for (const std::uint64_t value : values) Append(extra, value);
  return extra;
}

}  // namespace

Bytes ZipRecords::Add(const std::string& name, std::uint64_t offset, std::uint64_t size, std::uint32_t crc) {
  const bool zip64 = std::max(size, offset) >= zip64_from_;

  const Bytes local_extra = zip64 ? Zip64Extra({size, size}) : Bytes();
  Bytes header;
  Append(header, kLocalHeader);
  AppendEntry(header, name, size, crc, zip64, local_extra.size());
  Append(header, AsBytes(name));
  Append(header, ByteSpan(local_extra));

  const Bytes extra = zip64 ? Zip64Extra({size, size, offset}) : Bytes();
  Append(directory_, kDirectoryHeader);
  Append(directory_, zip64 ? kVersionZip64 : kVersion);  // made by: MS-DOS, thus without file modes
  AppendEntry(directory_, name, size, crc, zip64, extra.size());
  Append(directory_, std::uint16_t{0});  // comment length
  Append(directory_, std::uint32_t{0});  // disk number; internal attributes
  Append(directory_, std::uint32_t{0});  // external attributes
  Append(directory_, Low(offset, zip64));
  Append(directory_, AsBytes(name));
  Append(directory_, ByteSpan(extra));
  ++entries_;
  return header;
}

Bytes ZipRecords::End(std::uint64_t offset) {
  const std::uint64_t size = directory_.size();
  const std::uint64_t zip64_end = offset + size;
  const bool zip64 = entries_ >= kSeeZip64Count || zip64_end >= zip64_from_;
  Bytes out = directory_;
  if (zip64) {
    Append(out, kZip64End);
    Append(out, std::uint64_t{44});  // bytes that follow in this record
    Append(out, kVersionZip64);
    Append(out, kVersionZip64);
    Append(out, std::uint64_t{0});  // this disk; disk of the directory
    for (const std::uint64_t value : {entries_, entries_, size, offset}) Append(out, value);
    Append(out, kZip64Locator);
    Append(out, std::uint32_t{0});  // disk of the zip64 end
    Append(out, zip64_end);
    Append(out, std::uint32_t{1});  // disks
  }
  const std::uint16_t count = zip64 ? kSeeZip64Count : static_cast<std::uint16_t>(entries_);
  Append(out, kEnd);
  Append(out, std::uint32_t{0});  // this disk; disk of the directory
  Append(out, count);
  Append(out, count);
  Append(out, Low(size, zip64));
  Append(out, Low(offset, zip64));
  Append(out, std::uint16_t{0});  // comment length
  return out;
}

}  // namespace mascot
