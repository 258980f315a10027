#include "physics_server/wind.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace mascot {
namespace {

using Eigen::Vector3d;

const Vector3d kMean(4, -1, 0.5);
constexpr double kStd = 2;  // m/s
constexpr double kTau_s = 0.2;

WindConfig Gusts(double std_m_per_s = kStd) { return {kMean, std_m_per_s, kTau_s}; }

/// Gusts relative to the mean (m/s), for `duration_s`.
std::vector<Vector3d> Record(int rate_hz, double duration_s, std::uint64_t seed = 1) {
  Wind wind(Gusts(), seed, 1.0 / rate_hz);
  std::vector<Vector3d> gusts;
  for (int n = 0; n < duration_s * rate_hz; ++n) gusts.push_back(wind.Next() - kMean);
  return gusts;
}

/// Mean over time of g(t) g(t + lag)^T; `lag` in samples.
Eigen::Matrix3d Correlation(const std::vector<Vector3d>& gusts, std::size_t lag) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t n = lag; n < gusts.size(); ++n) sum += gusts[n - lag] * gusts[n].transpose();
  return sum / static_cast<double>(gusts.size() - lag);
}

// A record of length T has about T / (2 tau) independent samples: its mean has the standard deviation
// sigma sqrt(2 tau / T), its variance sigma^2 sqrt(2 tau / T): 1 % for T = 4000 s. Tolerances are five times that.
constexpr double kLong_s = 4000;
constexpr double kTolerance = 0.05;

class GustsAtARate : public testing::TestWithParam<int> {};

TEST_P(GustsAtARate, HaveTheStatisticsOfAFirstOrderGaussMarkovProcess) {
  const int rate_hz = GetParam();
  const std::vector<Vector3d> gusts = Record(rate_hz, kLong_s);
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& gust : gusts) mean += gust / static_cast<double>(gusts.size());
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), kTolerance * kStd);
  for (const double lag_s : {0.0, kTau_s, 3 * kTau_s}) {
    const Eigen::Matrix3d expected = kStd * kStd * std::exp(-lag_s / kTau_s) * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d found = Correlation(gusts, static_cast<std::size_t>(std::lround(lag_s * rate_hz)));
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kTolerance * kStd * kStd) << "lag " << lag_s << " s\n" << found;
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, GustsAtARate, testing::Values(5, 50, 500),
                         [](const auto& row) { return std::to_string(row.param) + "_hz"; });

TEST(Wind, IsStationaryFromItsFirstStep) {
  constexpr int kSeeds = 10000;
  Eigen::Matrix3d variance = Eigen::Matrix3d::Zero();
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Vector3d first = Record(100, 0.01, seed).front();
    variance += first * first.transpose() / kSeeds;
  }
  EXPECT_LT((variance - kStd * kStd * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.07 * kStd * kStd);
}

TEST(Wind, WithoutGustsIsExactlyTheMean) {
  Wind wind(Gusts(0), /*seed=*/1, /*dt_s=*/0.001);
  for (int n = 0; n < 10; ++n) EXPECT_EQ(wind.Next(), kMean);
}

TEST(Wind, IsTheSameForTheSameSeedAndAnotherForAnother) {
  EXPECT_EQ(Record(100, 1, 7), Record(100, 1, 7));
  EXPECT_NE(Record(100, 1, 7), Record(100, 1, 8));
}

TEST(Wind, ScalesItsGustsWithTheirStandardDeviation) {
  Wind one(Gusts(1), 1, 0.01), three(Gusts(3), 1, 0.01);
  for (int n = 0; n < 100; ++n) EXPECT_LT((3 * (one.Next() - kMean) - (three.Next() - kMean)).norm(), 1e-12);
}

}  // namespace
}  // namespace mascot
