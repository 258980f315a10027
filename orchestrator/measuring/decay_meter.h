#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace mascot {

/// Measures the exponential decay rate of a value, row by row: minus the slope of a straight line fitted to its
/// logarithm (least squares). The fit begins with the last row above 10 % of the first value and ends with the last row
/// above 0.02 % or, if the value does not stay below that, above 0.1 %; both rows are included. The last crossings of
/// so wide a range average out the oscillations of a value that oscillates.
class DecayMeter {
 public:
  /// Adds a row; times increase.
  void Add(double t_s, double value);
  /// The rate (1/s). Nothing if the value does not fall below 0.1 %, if it has stayed below for less than a tenth of
  /// the rows of the fit, or if the fit has fewer than 3 rows.
  std::optional<double> rate_per_s() const;

 private:
  struct Sums {
    std::int64_t rows = 0;
    double t = 0, y = 0, tt = 0, ty = 0;
  };

  std::optional<double> first_;
  double from_s_ = 0;               // time of the last row above 10 %; sums use t_s - from_s_
  Sums now_;                        // over the rows from from_s_ on
  std::array<Sums, 2> declines_{};  // the same, up to the last row above each lower end
};

}  // namespace mascot
