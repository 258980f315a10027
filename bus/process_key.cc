#include "bus/process_key.h"

#include <array>
#include <bit>
#include <cstring>
#include <sstream>

namespace mascot {
namespace {

using Octets = std::array<std::uint8_t, 8>;

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

ProcessKey ProcessKey::Of(const GuidPrefix& participant) { return {FirstEight(participant), ~std::uint64_t{0}}; }

bool ProcessKey::Fits(const GuidPrefix& participant) const { return (FirstEight(participant) & mask_) == bits_; }

std::string Text(const ProcessKey::GuidPrefix& participant) {
  std::ostringstream text;
  text << participant;
  return text.str();
}

}  // namespace mascot
