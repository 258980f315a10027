#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bus/sample_layout.h"

namespace mascot {

// Samples that carry samples: Bundle, Answers and TickRow of idl/mascot.idl, which network.delivery = "bundled" sends.
// Each is the encapsulation, a tick, and sections; a section is a number, the count of its bodies, and these bodies.

/// Bodies of samples, one behind the other.
struct SampleBodies {
  std::uint32_t count = 0;
  std::vector<std::uint8_t> bytes = {};

  void Clear() {
    count = 0;
    bytes.clear();
  }
  void Add(std::span<const std::uint8_t> body) {
    ++count;
    bytes.insert(bytes.end(), body.begin(), body.end());
  }
};

/// Writes such a sample. Keeps its memory from sample to sample.
class BundleWriter {
 public:
  void Begin(std::int64_t tick);
  /// Begins a section without bodies. `number`: Bundle::own, or a padding.
  void BeginSection(std::uint32_t number = 0);
  /// Adds room for a body of so many bytes, a multiple of 8, to the section. Valid until the next call.
  std::uint8_t* Add(std::size_t body);
  void Add(std::span<const std::uint8_t> body);
  void Add(const SampleBodies& bodies);

  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::uint8_t* Grow(std::size_t bytes);
  void Count(std::uint32_t more);

  std::vector<std::uint8_t> bytes_;
  std::size_t count_ = 0;  // where the count of the section stands
};

/// Reads such a sample, which must outlive it. Every function throws std::runtime_error for bytes that end too early,
/// or are of another kind.
class BundleReader {
 public:
  explicit BundleReader(std::span<const std::uint8_t> bytes);

  std::uint64_t tick() const { return tick_; }
  /// The next section, of bodies of this size.
  struct Section {
    std::uint32_t number = 0;
    std::size_t count = 0;
    std::size_t body = 0;
    const std::uint8_t* first = nullptr;

    std::span<const std::uint8_t> operator[](std::size_t k) const { return {first + k * body, body}; }
  };
  Section Next(std::size_t body);
  /// The next section, of messages: their bodies.
  std::span<const std::span<const std::uint8_t>> NextMessages();
  /// Throws if there is more.
  void End() const;

 private:
  std::span<const std::uint8_t> Take(std::size_t bytes);
  std::uint32_t TakeNumber();

  std::size_t whole_ = 0;
  std::span<const std::uint8_t> rest_;
  std::uint64_t tick_ = 0;
  std::vector<std::span<const std::uint8_t>> messages_;
};

}  // namespace mascot
