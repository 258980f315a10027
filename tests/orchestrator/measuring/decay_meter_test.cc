#include "orchestrator/measuring/decay_meter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace mascot {
namespace {

std::optional<double> RateOf(const std::function<double(double t_s)>& value, double end_s, double h = 0.01) {
  DecayMeter meter;
  for (int k = 0; k * h < end_s; ++k) meter.Add(k * h, value(k * h));
  return meter.rate_per_s();
}

TEST(DecayMeter, FindsTheRateOfAnExponentialWhateverItsUnits) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const auto rate = RateOf([scale](double t) { return scale * std::exp(-0.3 * t); }, 40);
    ASSERT_TRUE(rate);
    EXPECT_NEAR(*rate, 0.3, 1e-9);
  }
}

TEST(DecayMeter, FindsTheSlowerOfTwoRatesOnceTheFasterIsGone) {
  // Response from rest: 2 e^(-a t) - e^(-2 a t).
  const auto rate = RateOf([](double t) { return 2 * std::exp(-0.3 * t) - std::exp(-0.6 * t); }, 60);
  EXPECT_NEAR(*rate, 0.3, 0.003);
}

TEST(DecayMeter, AveragesOverOscillations) {
  for (const double w : {0.3, 0.7, 1.0, 3.0}) {
    const auto rate = RateOf([w](double t) { return std::abs(std::exp(-0.3 * t) * std::cos(w * t)); }, 80);
    ASSERT_TRUE(rate) << w;
    EXPECT_NEAR(*rate, 0.3, 0.05) << w;
  }
}

TEST(DecayMeter, IsNotMisledByAConstantFloor) {
  // A floor of 0.03 % of the first value: the rate is measured down to 0.1 %.
  const auto noisy = [](double t) { return std::exp(-0.3 * t) + 3e-4 * std::abs(std::sin(1e4 * t)); };
  EXPECT_NEAR(*RateOf(noisy, 60), 0.3, 0.02);
}

TEST(DecayMeter, FitsFromTheLastRowAboveATenthToTheLastAboveTheLowerEnd) {
  // Rows so far apart that each counts. Least squares over the logarithms of the rows that the documentation names.
  const auto slope = [](const std::vector<double>& values, std::size_t from, std::size_t to) {
    double n = 0, t = 0, y = 0, tt = 0, ty = 0;
    for (std::size_t k = from; k <= to; ++k) {
      const double x = static_cast<double>(k), log = std::log(values[k]);
      n += 1, t += x, y += log, tt += x * x, ty += x * log;
    }
    return (n * ty - t * y) / (n * tt - t * t);
  };
  const auto rate = [](const std::vector<double>& values) {
    DecayMeter meter;
    for (std::size_t k = 0; k < values.size(); ++k) meter.Add(static_cast<double>(k), values[k]);
    return meter.rate_per_s();
  };
  const std::vector<double> far = {1, 0.5, 0.11, 0.02, 0.009, 5e-4, 3e-4, 1e-5, 1e-7};
  EXPECT_NEAR(*rate(far), -slope(far, 2, 6), 1e-12) << "rows 2, of 11 %, to 6, of 0.03 %";
  const std::vector<double> from_the_start = {1, 0.08, 0.02, 5e-4, 1e-5, 1e-6};
  EXPECT_NEAR(*rate(from_the_start), -slope(from_the_start, 0, 3), 1e-12) << "row 0 is the last above 10 %";
  const std::vector<double> near = {1, 0.11, 0.02, 2e-3, 9e-4, 8e-4, 9e-4, 8e-4};
  EXPECT_NEAR(*rate(near), -slope(near, 1, 3), 1e-12) << "not below 0.02 %: to row 3, the last above 0.1 %";
  const std::vector<double> again = {1, 0.05, 0.2, 0.05, 0.01, 1e-4, 1e-5};
  EXPECT_NEAR(*rate(again), -slope(again, 2, 4), 1e-12) << "it was above 10 % again in row 2";
  EXPECT_FALSE(rate({1, 0.05, 1e-5, 1e-6, 1e-7})) << "two rows make no fit";
}

TEST(DecayMeter, HasNoRateOfAValueThatDoesNotFallFarOrNotForGood) {
  EXPECT_FALSE(RateOf([](double t) { return std::exp(-0.3 * t); }, 20)) << "0.25 % at the end";
  EXPECT_FALSE(RateOf([](double t) { return std::exp(-0.3 * t) + 2e-3; }, 60)) << "stays above";
  EXPECT_FALSE(RateOf([](double t) { return std::exp(-0.3 * t); }, std::log(1000) / 0.3 + 0.1)) << "just arrived";
  EXPECT_FALSE(RateOf([](double) { return 0.0; }, 60)) << "nothing to decay";
  EXPECT_FALSE(RateOf([](double t) { return t < 30 ? std::exp(-0.3 * t) : 1.0; }, 60)) << "came back";
}

}  // namespace
}  // namespace mascot
