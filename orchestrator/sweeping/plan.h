#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// One run of a sweep: what is set, on top of the experiment file.
struct SweepPoint {
  std::vector<Override> overrides;  ///< in the order of SweepPlan::keys()
};

/// What a sweep runs: every combination of the values of its keys, of its random samples and of its seeds, in this
/// order, seeds changing fastest. The same words give the same plan.
class SweepPlan {
 public:
  /// Words of the command line. Each throws ConfigError, naming the option and what was expected.
  struct Words {
    std::vector<std::string> sets;     ///< --set KEY=A:STEP:B | KEY=V1,V2,... | KEY=VALUE
    std::vector<std::string> randoms;  ///< --random KEY=MIN:MAX[:log]
    std::int64_t samples = 1;          ///< --samples: draws of all random keys
    std::string seeds;                 ///< --seeds A..B | A,B,...; "": that of the file
  };
  explicit SweepPlan(const Words& words);

  /// Columns: the keys as typed, then run.seed if --seeds was given.
  const std::vector<std::string>& keys() const { return keys_; }
  std::size_t size() const { return points_.size(); }
  const SweepPoint& operator[](std::size_t index) const { return points_[index]; }
  /// Keys that have more than one value, without seeds: what there is to draw.
  const std::vector<std::string>& varied() const { return varied_; }

 private:
  std::vector<std::string> keys_;
  std::vector<std::string> varied_;
  std::vector<SweepPoint> points_;
};

}  // namespace mascot
