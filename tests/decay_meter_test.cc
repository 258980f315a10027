#include "orchestrator/measuring/decay_meter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

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

TEST(DecayMeter, HasNoRateOfAValueThatDoesNotFallFarOrNotForGood) {
  EXPECT_FALSE(RateOf([](double t) { return std::exp(-0.3 * t); }, 20)) << "0.25 % at the end";
  EXPECT_FALSE(RateOf([](double t) { return std::exp(-0.3 * t) + 2e-3; }, 60)) << "stays above";
  EXPECT_FALSE(RateOf([](double t) { return std::exp(-0.3 * t); }, std::log(1000) / 0.3 + 0.1)) << "just arrived";
  EXPECT_FALSE(RateOf([](double) { return 0.0; }, 60)) << "nothing to decay";
  EXPECT_FALSE(RateOf([](double t) { return t < 30 ? std::exp(-0.3 * t) : 1.0; }, 60)) << "came back";
}

}  // namespace
}  // namespace mascot
