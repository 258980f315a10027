#pragma once

#include <cstdint>
#include <random>

namespace mascot {

/// Random numbers that are the same with every C++ library: the engine is standardised bit by bit, the
/// standard's distributions are not. Each use has a stream of its own, so that one more draw here moves nothing there.
class Random {
 public:
  enum class Stream : std::uint32_t { kPositions = 1, kGraph = 2 };

  Random(std::uint64_t seed, Stream stream) : engine_(Sequence(seed, stream)) {}

  /// Uniform in [0, 1), 53 bits.
  double Unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double In(double min, double max) { return min + (max - min) * Unit(); }
  /// Uniform in 0 .. count - 1.
  std::size_t Below(std::size_t count) { return static_cast<std::size_t>(Unit() * static_cast<double>(count)); }

 private:
  static std::mt19937_64 Sequence(std::uint64_t seed, Stream stream) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(stream)};
    return std::mt19937_64(words);
  }
  std::mt19937_64 engine_;
};

}  // namespace mascot
