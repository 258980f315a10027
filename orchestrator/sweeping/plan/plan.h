#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// Keys that mean more to a sweep than others.
inline constexpr std::string_view kSeedKey = "run.seed", kLawKey = "law.name";

/// A sweep has at most so many runs.
inline constexpr std::size_t kMaxRuns = 10'000'000;

/// One run of a sweep: the keys that it sets, in addition to the experiment file. Mistakes that their values make are
/// said to be of the option that gave them: "--set law.beta=-1", "--random law.beta=-1:1 (-0.25)", "--seeds 3".
struct SweepPoint {
  std::vector<Override> overrides;  ///< in the order of SweepPlan::keys()
};

/// The runs of a sweep: every combination of key values, random samples and seeds, in this order; seeds change fastest.
/// The same options give the same plan. Runs are made when asked for: a plan takes the memory of its keys' values.
class SweepPlan {
 public:
  /// Command-line options, as typed.
  struct Words {
    std::vector<std::string> sets;     ///< --set KEY=A:STEP:B | KEY=V1,V2,... | KEY=VALUE
    std::vector<std::string> randoms;  ///< --random KEY=MIN:MAX[:log]
    std::int64_t samples = 1;          ///< --samples: how often all random keys are drawn
    std::string seeds;                 ///< --seeds A..B | A,B,...; "": the seed of the file
    bool operator==(const Words&) const = default;
  };
  /// Throws ConfigError for an invalid option, naming the option and what was expected.
  explicit SweepPlan(const Words& words);

  /// The options that give the same plan, however they were typed: with values as PlainValue() (values.h) has them,
  /// each once.
  Words words() const;
  /// For the terminal: of which keys equal values were given more than once.
  const std::vector<std::string>& notes() const { return notes_; }

  /// The keys that are set: those of --set and --random as typed, then run.seed if --seeds was given.
  const std::vector<std::string>& keys() const { return keys_; }
  std::size_t size() const { return size_; }
  SweepPoint operator[](std::size_t run) const;
  /// Keys with more than one value, without run.seed: the axes of a plot.
  const std::vector<std::string>& varied() const { return varied_; }
  /// The values of a key, in plain text (values.h); empty if it is not set by --set or --seeds.
  std::span<const std::string> ValuesOf(std::string_view key) const;
  /// The first run with each other value that --set gives a key; of A:STEP:B only with the last one.
  const std::vector<SweepPoint>& trials() const { return trials_; }
  /// Which runs count as alike: those that set the same values, or those that set the same words, whatever the numbers.
  /// In both, run.seed may differ.
  enum class Alike { kInValues, kInWords };
  /// For each run the first one that is alike.
  class Representatives {
   public:
    std::size_t operator[](std::size_t run) const;

   private:
    friend SweepPlan;
    /// Keys whose values change together.
    struct Digit {
      std::size_t stride = 1;          ///< they change after so many runs
      std::vector<std::size_t> first;  ///< for each value the place of the first one that is alike
    };
    std::vector<Digit> digits_;
  };
  Representatives RepresentativesOf(Alike alike) const;
  /// The runs with the first value of run.seed, if it has several; else none.
  std::vector<std::size_t> WithFirstSeed() const;
  /// What tells this plan from others: a line for each key.
  std::string Text() const;
  /// What a key is set to, in words: "0.1, 0.5", "0.1:1, 20 samples"; empty: it is not set.
  std::string SettingOf(std::string_view key) const;

 private:
  struct Axis {
    std::string key;
    std::vector<std::string> values;
    bool is_range = false;   ///< of A:STEP:B
    std::string range = {};  ///< "0.1:0.1:1", or of --random "0.1:1:log", which has `drawn` in the place of values
    std::vector<double> drawn = {};
    std::size_t stride = 1;  ///< the value changes after so many runs

    std::size_t size() const { return drawn.empty() ? values.size() : drawn.size(); }
    std::string Value(std::size_t k) const;
  };
  static Axis ParseSet(const std::string& word);
  static Axis ParseRandom(const std::string& word, std::uint64_t place, std::int64_t samples);
  void AddAxis(const Axis& axis);
  void KeepEachOnce(Axis& axis);
  void KeepOneIfEqual(std::vector<Axis>& drawn);
  void Multiply(std::size_t by);
  void AddTrials(std::size_t sets);
  bool IsOfSeeds(const Axis& axis) const { return has_seeds_ && &axis == &axes_.back(); }

  std::vector<std::string> keys_;
  std::vector<Axis> axes_;  // of keys_
  bool has_seeds_ = false;  // the last axis is that of --seeds
  std::vector<std::string> varied_;
  std::vector<std::string> notes_;
  std::size_t size_ = 1;
  std::vector<SweepPoint> trials_;
};

}  // namespace mascot
