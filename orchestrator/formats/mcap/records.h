#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "orchestrator/formats/bytes.h"

/// The elements of MCAP (https://mcap.dev/spec) that writer and reader share: opcodes, framing, fields.
/// Integers are little endian; a string is u32 length + UTF-8; a map is u32 byte length + entries.
namespace mascot::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kFrameBytes = 9;  ///< opcode and body length, before every body
/// Largest chunk, uncompressed, that is written or accepted (bytes).
inline constexpr std::size_t kMaxChunkBytes = std::size_t{64} << 20;
/// Largest record that is accepted (bytes): a chunk that could not be compressed, or a large attachment.
inline constexpr std::size_t kMaxRecordBytes = std::size_t{256} << 20;

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kAttachment,
  kAttachmentIndex,
  kStatistics,
  kMetadata,
  kMetadataIndex,
  kSummaryOffset,
  kDataEnd,
};

/// Appends one record to `out`, field by field. End(), to be called last, fills in the length.
class Record {
 public:
  Record(Bytes& out, Op op) : out_(out), start_(out.size()) {
    U8(static_cast<std::uint8_t>(op));
    U64(0);
  }
  Record& U8(std::uint8_t value) { return Put(value); }
  Record& U16(std::uint16_t value) { return Put(value); }
  Record& U32(std::uint32_t value) { return Put(value); }
  Record& U64(std::uint64_t value) { return Put(value); }
  Record& Raw(ByteSpan bytes) { return Put(bytes); }
  Record& String(std::string_view text) { return U32(static_cast<std::uint32_t>(text.size())).Raw(AsBytes(text)); }
  Record& Map(const std::map<std::string, std::string>& entries) {
    std::size_t bytes = 0;
    for (const auto& [key, value] : entries) bytes += 8 + key.size() + value.size();
    U32(static_cast<std::uint32_t>(bytes));
    for (const auto& [key, value] : entries) String(key).String(value);
    return *this;
  }
  /// `beyond`: number of bytes of the body that the caller writes itself, after `out`.
  void End(std::uint64_t beyond = 0) {
    const std::uint64_t length = out_.size() - start_ - kFrameBytes + beyond;
    std::memcpy(&out_[start_ + 1], &length, sizeof length);
  }

 private:
  template <class T>
  Record& Put(T value) {
    Append(out_, value);
    return *this;
  }

  Bytes& out_;
  std::size_t start_;
};

/// Damage: a record does not fit the specification, a CRC or the bytes in the file.
struct Malformed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads the fields of a record's body, in order. Throws Malformed instead of reading beyond its end.
class Fields {
 public:
  explicit Fields(ByteSpan body) : rest_(body) {}
  std::uint8_t U8() { return Integer<std::uint8_t>(); }
  std::uint16_t U16() { return Integer<std::uint16_t>(); }
  std::uint32_t U32() { return Integer<std::uint32_t>(); }
  std::uint64_t U64() { return Integer<std::uint64_t>(); }
  ByteSpan Raw(std::uint64_t bytes) {
    if (bytes > rest_.size()) throw Malformed("a field runs past the end of its record");
    const ByteSpan taken = rest_.first(static_cast<std::size_t>(bytes));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  std::string String() {
    const ByteSpan bytes = Raw(U32());
    return {bytes.begin(), bytes.end()};
  }
  std::map<std::string, std::string> Map() {
    std::map<std::string, std::string> entries;
    for (Fields map(Raw(U32())); !map.rest().empty();) {
      std::string key = map.String();
      entries[std::move(key)] = map.String();
    }
    return entries;
  }
  ByteSpan rest() const { return rest_; }

 private:
  template <class T>
  T Integer() {
    T value;
    std::memcpy(&value, Raw(sizeof value).data(), sizeof value);
    return value;
  }

  ByteSpan rest_;
};

}  // namespace mascot::mcap
