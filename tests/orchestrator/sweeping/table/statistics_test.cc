#include "orchestrator/sweeping/table/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mascot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Student, HasTheQuantilesOfThePrintedTables) {
  // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2, with more digits.
  for (const auto& [degrees, t] : {std::pair{1, 12.706204736},
                                   {2, 4.302652730},
                                   {3, 3.182446305},
                                   {4, 2.776445105},
                                   {5, 2.570581836},
                                   {9, 2.262157163},
                                   {19, 2.093024054},
                                   {29, 2.045229642},
                                   {99, 1.984216952},
                                   {1000, 1.962339081}})
    EXPECT_NEAR(StudentQuantile(0.975, static_cast<std::size_t>(degrees)), t, 1e-8) << degrees;
}

TEST(Student, HasTheClosedFormsOfOneAndTwoDegreesOfFreedom) {
  for (const double p : {0.6, 0.9, 0.95, 0.975, 0.995}) {
    EXPECT_NEAR(StudentQuantile(p, 1), std::tan(std::numbers::pi * (p - 0.5)), 1e-9);  // Cauchy's distribution
    EXPECT_NEAR(StudentQuantile(p, 2), (2 * p - 1) / std::sqrt(2 * p * (1 - p)), 1e-10);
    EXPECT_NEAR(StudentQuantile(p, 7), -StudentQuantile(1 - p, 7), 1e-12);
  }
}

TEST(Quantile, LiesBetweenNeighboursByLinearInterpolation) {
  const ValueSample sample{{40, 10, 30, 20}, 0};
  EXPECT_EQ(QuantileOf(sample, 0), 10);
  EXPECT_EQ(QuantileOf(sample, 1), 40);
  EXPECT_DOUBLE_EQ(QuantileOf(sample, 0.5), 25);
  EXPECT_DOUBLE_EQ(QuantileOf(sample, 0.1), 13);
  EXPECT_EQ(QuantileOf({{7}, 0}, 0.9), 7);
}

TEST(Quantile, LiesBeyondTheValuesWhereMostOfTheSampleDoes) {
  EXPECT_EQ(QuantileOf({{10, 20, 30}, 2}, 0.5), 30);
  EXPECT_EQ(QuantileOf({{10, 20, 30}, 2}, 0.9), kInfinity);
  EXPECT_EQ(QuantileOf({{10}, 1}, 0.5), kInfinity) << "half-way to infinity";
  EXPECT_EQ(QuantileOf({{}, 3}, 0.1), kInfinity);
  EXPECT_EQ(QuantileOf({{10}, 3}, 0.9), kInfinity) << "between two infinities";
}

TEST(Spread, HasStudentsConfidenceInterval) {
  // s = sqrt(2.5), so that the interval is 3 -+ 2.776445 sqrt(2.5 / 5).
  const Spread spread = SpreadOf({{1, 2, 3, 4, 5}, 0});
  EXPECT_EQ(spread.mean, 3);
  EXPECT_NEAR(spread.half_width.value_or(0), 2.7764451052 * std::sqrt(0.5), 1e-9);
  EXPECT_EQ(spread.median, 3);
  EXPECT_DOUBLE_EQ(spread.decile_1.value_or(0), 1.4);
  EXPECT_DOUBLE_EQ(spread.decile_9.value_or(0), 4.6);
}

TEST(Spread, ShrinksAsTheRootOfTheSampleAndNotWithAShift) {
  std::vector<double> few, many;
  for (int i = 0; i < 400; ++i) (i < 100 ? few : many).push_back(i % 2);
  many.insert(many.end(), few.begin(), few.end());
  const double ratio = SpreadOf({few, 0}).half_width.value_or(0) / SpreadOf({many, 0}).half_width.value_or(1);
  EXPECT_NEAR(ratio, 2, 0.03);
  std::vector<double> shifted = few;
  for (double& value : shifted) value += 1000;
  EXPECT_NEAR(SpreadOf({few, 0}).half_width.value_or(0), SpreadOf({shifted, 0}).half_width.value_or(1), 1e-12);
}

TEST(Spread, SaysNothingThatTheSampleDoesNot) {
  const Spread none = SpreadOf({});
  EXPECT_FALSE(none.mean || none.half_width || none.median);
  const Spread one = SpreadOf({{4}, 0});
  EXPECT_EQ(one.mean, 4);
  EXPECT_FALSE(one.half_width);
  EXPECT_EQ(one.median, 4);
  const Spread late = SpreadOf({{}, 2});
  EXPECT_FALSE(late.mean);
  EXPECT_EQ(late.median, kInfinity);
}

}  // namespace
}  // namespace mascot
