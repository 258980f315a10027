#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// One run of a sweep: the keys that it sets, in addition to the experiment file.
struct SweepPoint {
  std::vector<Override> overrides;  ///< in the order of SweepPlan::keys()
};

/// The runs of a sweep: every combination of key values, random samples and seeds, in this order; seeds change fastest.
/// The same options give the same plan.
class SweepPlan {
 public:
  /// Command-line options, as typed.
  struct Words {
    std::vector<std::string> sets;     ///< --set KEY=A:STEP:B | KEY=V1,V2,... | KEY=VALUE
    std::vector<std::string> randoms;  ///< --random KEY=MIN:MAX[:log]
    std::int64_t samples = 1;          ///< --samples: how often all random keys are drawn
    std::string seeds;                 ///< --seeds A..B | A,B,...; "": the seed of the file
  };
  /// Throws ConfigError for an invalid option, naming the option and what was expected.
  explicit SweepPlan(const Words& words);

  /// The keys that are set: those of --set and --random as typed, then run.seed if --seeds was given.
  const std::vector<std::string>& keys() const { return keys_; }
  std::size_t size() const { return points_.size(); }
  const SweepPoint& operator[](std::size_t index) const { return points_[index]; }
  /// Keys with more than one value, without run.seed: the axes of a plot.
  const std::vector<std::string>& varied() const { return varied_; }

 private:
  std::vector<std::string> keys_;
  std::vector<std::string> varied_;
  std::vector<SweepPoint> points_;
};

}  // namespace mascot
