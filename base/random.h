#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace mascot {

/// Random numbers that are the same with every C++ library: the engine is standardised bit by bit, the standard's
/// distributions are not. Each use has a stream of its own, so that an extra draw in one does not change another.
class Random {
 public:
  enum class Stream : std::uint32_t {
    kPositions = 1,
    kGraph = 2,
    kSweep = 3,
    kVelocities = 4,
    kHeadings = 5,
    kEpisodes = 6
  };

  Random(std::uint64_t seed, Stream stream) : engine_(Sequence(seed, stream)) {}

  /// Uniform in [0, 1), 53 bits.
  double Unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  /// Uniform in [min, max).
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

/// Random numbers by name instead of by order (a counter-based generator): each number is a hash of its purpose, so
/// that it does not depend on which others were drawn, or when, or in which process.
class Dice {
 public:
  enum class Stream : std::uint64_t {
    kLink = 1,
    kOwnSensor,
    kHeardSensor,
    kWind,
    kFalseData,
    kFaultySensor,
    kFaultyMotor,
    kFaultyLink
  };

  /// `a` and `b` name the owner of the numbers: an agent, or the two agents of an edge.
  Dice(std::uint64_t seed, Stream stream, std::uint64_t a = 0, std::uint64_t b = 0)
      : key_(Mix(Mix(Mix(Mix(seed) + static_cast<std::uint64_t>(stream)) + a) + b)) {}

  /// Uniform in [0, 1), 53 bits: draw number `draw` at `n`, a tick or a step.
  double Unit(std::int64_t n, std::uint64_t draw) const {
    return static_cast<double>(Mix(Mix(key_ + static_cast<std::uint64_t>(n)) + draw) >> 11) * 0x1.0p-53;
  }
  /// Gaussian with mean 0 and variance 1 (Box & Muller, Ann. Math. Stat. 29, 1958), from draws 2 draw and 2 draw + 1.
  double Normal(std::int64_t n, std::uint64_t draw) const {
    const double radius = std::sqrt(-2 * std::log1p(-Unit(n, 2 * draw)));
    return radius * std::cos(2 * std::numbers::pi * Unit(n, 2 * draw + 1));
  }

 private:
  // The step of SplitMix64: Steele, Lea & Flood, "Fast splittable pseudorandom number generators" (OOPSLA 2014).
  static std::uint64_t Mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t key_;
};

}  // namespace mascot
