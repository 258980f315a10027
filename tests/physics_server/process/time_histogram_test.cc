#include "physics_server/process/time_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace mascot {
namespace {

TEST(TimeHistogram, KnowsNoDurationBeforeTheFirst) {
  EXPECT_EQ(TimeHistogram().count(), 0u);
  EXPECT_EQ(TimeHistogram().Quantile(0.5), 0);
  EXPECT_EQ(TimeHistogram().Quantile(1), 0);
}

TEST(TimeHistogram, QuantilesAreThoseOfTheSortedDurationsWithinABin) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-8, 3);
  TimeHistogram histogram;
  std::vector<double> all;
  for (int k = 0; k < 10001; ++k) {
    all.push_back(std::pow(10, exponent(random)));
    histogram.Add(all.back());
  }
  std::ranges::sort(all);
  EXPECT_EQ(histogram.count(), all.size());
  for (const double part : {0.01, 0.1, 0.5, 0.9, 0.99, 0.999}) {
    const auto place = static_cast<std::size_t>(std::ceil(part * static_cast<double>(all.size()))) - 1;
    EXPECT_NEAR(histogram.Quantile(part), all[place], 0.006 * all[place]) << part;
  }
  EXPECT_EQ(histogram.Quantile(1), all.back()) << "exact";
}

TEST(TimeHistogram, DurationsOfAnySizeAreCounted) {
  TimeHistogram histogram;
  for (const double duration_s : {-1.0, 0.0, 1e-12}) histogram.Add(duration_s);
  EXPECT_EQ(histogram.Quantile(0.5), 0);
  EXPECT_EQ(histogram.Quantile(1), 1e-12);
  for (int k = 0; k < 4; ++k) histogram.Add(1e9);
  EXPECT_EQ(histogram.count(), 7u);
  EXPECT_EQ(histogram.Quantile(1), 1e9);
  EXPECT_GT(histogram.Quantile(0.99), 1e5) << "the last bin";
}

}  // namespace
}  // namespace mascot
