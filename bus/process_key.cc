#include "bus/process_key.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <sstream>

namespace mascot {
namespace {

using Octets = std::array<std::uint8_t, 8>;

constexpr std::size_t kOfSubject = 6;  // bytes of a GUID that tell the subject of a certificate

constexpr auto kMaskOfSubject = std::bit_cast<std::uint64_t>(Octets{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0, 0});

/// The key of the GUIDs that begin with these bytes, of which the last two do not count.
ProcessKey KeyOfSubject(const Octets& bytes) { return {std::bit_cast<std::uint64_t>(bytes), kMaskOfSubject}; }

std::uint64_t FirstEight(const ProcessKey::GuidPrefix& participant) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, participant.value, sizeof bits);
  return bits;
}

}  // namespace

ProcessKey ProcessKey::WithPid(pid_t pid) {
  const auto low = static_cast<std::uint8_t>(pid), high = static_cast<std::uint8_t>(pid >> 8);
  constexpr std::uint8_t kFastDds = 0x0f;
  return {std::bit_cast<std::uint64_t>(Octets{1, kFastDds, 0, 0, low, high, 0, 0}),
          std::bit_cast<std::uint64_t>(Octets{0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0})};
}

// DDS Security 1.1, 9.3.3.2: a bit that is set, then the first 47 bits of the digest.
ProcessKey ProcessKey::WithSubject(std::span<const std::uint8_t> digest) {
  Octets bytes{};
  for (std::size_t k = 0; k < kOfSubject; ++k) {
    const int before = k == 0 ? 1 : digest[k - 1];
    bytes[k] = static_cast<std::uint8_t>((before << 7) | (digest[k] >> 1));
  }
  return KeyOfSubject(bytes);
}

ProcessKey ProcessKey::Of(const GuidPrefix& participant) { return {FirstEight(participant), ~std::uint64_t{0}}; }

bool ProcessKey::IsOfSubject() const { return mask_ == kMaskOfSubject; }

std::string ProcessKey::ToHex() const {
  const auto bytes = std::bit_cast<Octets>(bits_);
  std::string digits;
  for (std::size_t k = 0; k < kOfSubject; ++k) digits += fmt::format("{:02x}", bytes[k]);
  return digits;
}

std::optional<ProcessKey> ProcessKey::FromHex(std::string_view digits) {
  if (digits.size() != 2 * kOfSubject) return std::nullopt;
  Octets bytes{};
  for (std::size_t k = 0; k < kOfSubject; ++k) {
    const char* const begin = digits.data() + 2 * k;
    if (std::from_chars(begin, begin + 2, bytes[k], 16).ptr != begin + 2) return std::nullopt;
  }
  return KeyOfSubject(bytes);
}

bool ProcessKey::Fits(const GuidPrefix& participant) const { return (FirstEight(participant) & mask_) == bits_; }

std::string Text(const ProcessKey::GuidPrefix& participant) {
  std::ostringstream text;
  text << participant;
  return text.str();
}

}  // namespace mascot
