#pragma once

#include <sys/types.h>

#include <cstdint>
#include <fastdds/rtps/common/GuidPrefix_t.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mascot {

/// The first eight bytes of the GUID prefixes of a process's participants, as far as they are known. Fast DDS puts into
/// them, two bytes each: its own vendor id, the host, the low bits of the process id, a number that the process has
/// drawn. They are the same for all participants of a process; the last four bytes of the prefix differ. With
/// network.security, the first six bytes tell the subject of the participant's certificate, which its peers have
/// verified, and the others are its own.
class ProcessKey {
 public:
  using GuidPrefix = eprosima::fastrtps::rtps::GuidPrefix_t;

  /// Fits no participant: the process is not known yet.
  ProcessKey() = default;
  /// Fits every participant: the first one that comes is believed.
  static ProcessKey Anybody() { return {0, 0}; }
  /// Fits a process that this host has started, of which only the process id is known until it joins the domain.
  static ProcessKey WithPid(pid_t pid);
  /// Fits every participant that has authenticated itself by a certificate whose subject has this SHA-256 digest, of 32
  /// bytes.
  static ProcessKey WithSubject(std::span<const std::uint8_t> digest);
  /// Fits exactly the process of this participant.
  static ProcessKey Of(const GuidPrefix& participant);
  /// The key with these bits() and mask(), which another process has sent.
  ProcessKey(std::uint64_t bits, std::uint64_t mask) : bits_(bits), mask_(mask) {}

  bool Fits(const GuidPrefix& participant) const;
  /// Whether this key fits the process with this exact key.
  bool Fits(const ProcessKey& exact) const { return (exact.bits_ & mask_) == bits_; }
  /// Whether no other process can fit.
  bool IsExact() const { return mask_ == ~std::uint64_t{0}; }
  /// Whether it is as WithPid() or WithSubject() make it.
  bool IsOfAStart() const { return mask_ != 0 && !IsExact(); }
  /// Whether it is as WithSubject() makes it.
  bool IsOfSubject() const;
  bool IsNobody() const { return mask_ == 0 && bits_ != 0; }
  bool IsWildcard() const { return mask_ == 0 && bits_ == 0; }
  /// A key that WithSubject() has made, as twelve hexadecimal digits, and back; nullopt: it is something else.
  std::string ToHex() const;
  static std::optional<ProcessKey> FromHex(std::string_view digits);
  std::uint64_t bits() const { return bits_; }
  std::uint64_t mask() const { return mask_; }

 private:
  std::uint64_t bits_ = 1, mask_ = 0;  // the first eight bytes, and which bits of them are known
};

/// A participant as Fast DDS prints it: "01.0f.78.fd.f5.37.39.de.00.00.00.00".
std::string Text(const ProcessKey::GuidPrefix& participant);

}  // namespace mascot
