#pragma once

#include <libdeflate.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mascot {

// Our file formats (MCAP, zip, npy, CDR) are little endian; integers are copied as they are in memory.
static_assert(std::endian::native == std::endian::little);

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

inline ByteSpan AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Views numbers as their bytes in memory.
template <class T>
requires std::is_arithmetic_v<T> ByteSpan AsBytes(std::span<const T> numbers) {
  return {reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size_bytes()};
}

inline void Append(Bytes& out, ByteSpan bytes) {
  if (bytes.empty()) return;
  out.resize(out.size() + bytes.size());
  std::memcpy(out.data() + out.size() - bytes.size(), bytes.data(), bytes.size());
}

template <class T>
requires std::is_arithmetic_v<T>
void Append(Bytes& out, T number) { Append(out, AsBytes(std::span<const T>(&number, 1))); }

/// CRC-32 (ISO-HDLC, as in zip and MCAP). Continues `crc`, the CRC of the bytes before `bytes`; start with 0.
inline std::uint32_t Crc32(std::uint32_t crc, ByteSpan bytes) {
  return libdeflate_crc32(crc, bytes.data(), bytes.size());  // several times as fast as zlib's, where there is PCLMUL
}

}  // namespace mascot
