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

TEST_P(GustsAtARate, AreRenewedByIndependentNormalNumbers) {
  // xi = (g+ - rho g) / (sigma sqrt(1 - rho^2)): mean 0, variance 1, kurtosis 3, and nothing of the last one is in it.
  // Of n numbers, their means have the standard deviations sqrt(1/n), sqrt(2/n), sqrt(96/n) and sqrt(1/n).
  const int rate_hz = GetParam();
  const double rho = std::exp(-1 / (rate_hz * kTau_s));
  const std::vector<Vector3d> gusts = Record(rate_hz, 4000.0 * 5 / rate_hz);
  double mean = 0, square = 0, fourth = 0, with_last = 0;
  Vector3d last = Vector3d::Zero();
  const double n = 3.0 * static_cast<double>(gusts.size() - 1);
  for (std::size_t k = 1; k < gusts.size(); ++k) {
    const Vector3d xi = (gusts[k] - rho * gusts[k - 1]) / (kStd * std::sqrt(1 - rho * rho));
    mean += xi.sum() / n;
    square += xi.squaredNorm() / n;
    fourth += xi.array().pow(4).sum() / n;
    with_last += xi.dot(last) / n;
    last = xi;
  }
  EXPECT_NEAR(mean, 0, 5 * std::sqrt(1 / n));
  EXPECT_NEAR(square, 1, 5 * std::sqrt(2 / n));
  EXPECT_NEAR(fourth, 3, 5 * std::sqrt(96 / n));
  EXPECT_NEAR(with_last, 0, 5 * std::sqrt(1 / n));
}

TEST(Wind, IsTheSameForTheSameSeedAndHasNothingOfItForAnother) {
  const std::vector<Vector3d> seven = Record(100, kLong_s, 7), eight = Record(100, kLong_s, 8);
  EXPECT_EQ(Record(100, 1, 7), std::vector<Vector3d>(seven.begin(), seven.begin() + 100));
  Eigen::Matrix3d common = Eigen::Matrix3d::Zero();
  for (std::size_t n = 0; n < seven.size(); ++n)
    common += seven[n] * eight[n].transpose() / static_cast<double>(seven.size());
  EXPECT_LT(common.cwiseAbs().maxCoeff(), kTolerance * kStd * kStd);
}

TEST(Wind, GoesOnFromItsGustWhenAnEventChangesIt) {
  Wind as_it_was(Gusts(), 1, 0.01), changed(Gusts(), 1, 0.01);
  Vector3d gust = Vector3d::Zero();
  for (int n = 0; n < 10; ++n) gust = changed.Next() - kMean;
  for (int n = 0; n < 10; ++n) as_it_was.Next();
  Vector3d last_before = gust;
  const WindConfig now = {{1, 1, 1}, 5, 0.7};
  changed.Adopt(now);
  for (int n = 0; n < 10; ++n) {  // the same numbers are drawn, and taken as the new deviation and time have it
    const Vector3d before = as_it_was.Next() - kMean, after = changed.Next() - now.mean_m_per_s;
    const double rho_was = std::exp(-0.01 / kTau_s), rho = std::exp(-0.01 / 0.7);
    const Vector3d xi = (before - rho_was * last_before) / (kStd * std::sqrt(1 - rho_was * rho_was));
    EXPECT_LT((after - (rho * gust + 5 * std::sqrt(1 - rho * rho) * xi)).norm(), 1e-9);
    last_before = before;
    gust = after;
  }
}

TEST(Wind, ScalesItsGustsWithTheirStandardDeviation) {
  Wind one(Gusts(1), 1, 0.01), three(Gusts(3), 1, 0.01);
  for (int n = 0; n < 100; ++n) EXPECT_LT((3 * (one.Next() - kMean) - (three.Next() - kMean)).norm(), 1e-12);
}

}  // namespace
}  // namespace mascot
