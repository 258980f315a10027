#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace mascot {

/// A sample of independent values. Some may be known only to lie beyond all others: settling times of runs that had not
/// settled by their end.
struct ValueSample {
  std::vector<double> values;
  std::size_t beyond = 0;
};

/// What a sample says about where its values lie.
struct Spread {
  std::optional<double> mean;        ///< of the values alone; absent: there is none
  std::optional<double> half_width;  ///< of the 95 % confidence interval of the mean; absent: fewer than two values
  /// Median, first and ninth decile, of all: infinity where they lie beyond the values. Absent: the sample is empty.
  std::optional<double> median, decile_1, decile_9;
};

/// The value that Student's t with `degrees` (>= 1) degrees of freedom stays below with probability `p`, in (0, 1).
double StudentQuantile(double p, std::size_t degrees);
/// The quantile q in [0, 1] of a sample that is not empty, between neighbouring values by linear interpolation (Hyndman
/// & Fan, Am. Stat. 50, 1996, number 7: as NumPy and R have it).
double QuantileOf(ValueSample sample, double q);
/// The interval mean -+ t s / sqrt(n) of Student (Biometrika 6, 1908), s the standard deviation of n values.
Spread SpreadOf(const ValueSample& sample);

}  // namespace mascot
