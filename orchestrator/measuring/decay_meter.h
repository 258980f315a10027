#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace mascot {

/// Measures how fast something decays, row by row: minus the slope of a straight line through its logarithm (least
/// squares), from the last row above 10 % of its start to the last above 0.02 %, or, if it does not fall that far,
/// above 0.1 %. From the last rows, and over so much of the way, so that what swings is measured over its swings.
class DecayMeter {
 public:
  /// The next row; times increase.
  void Add(double t_s, double value);
  /// Nothing if it does not fall that far, or not for good: if it has not stayed there for a tenth of the way down.
  std::optional<double> rate_per_s() const;

 private:
  struct Sums {
    std::int64_t rows = 0;
    double t = 0, y = 0, tt = 0, ty = 0;
  };

  std::optional<double> first_;
  double from_s_ = 0;               // times count from here
  Sums now_;                        // since the last row above 10 %
  std::array<Sums, 2> declines_{};  // of those, up to the last row above each lower end
};

}  // namespace mascot
