#include "orchestrator/theory/modes.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

namespace mascot {
namespace {

using Complex = std::complex<double>;

/// x of a mode at each tick, from rest, by simulating its recursion: an independent reference.
std::vector<Complex> FromRest(const LinearMode& mode, double h, int ticks) {
  std::vector<Complex> x = {1};
  Complex v = 0;
  for (int k = 0; k < ticks; ++k) {
    const Complex u = -mode.stiffness * x.back() - mode.damping * v;
    if (mode.order == 1) {
      x.push_back(x.back() + h * u);
    } else {
      x.push_back(x.back() + h * v + mode.hold * h * h * u);
      v += h * u;
    }
  }
  return x;
}

/// The tick from which on |x| stays within 2 %.
int Settled(const std::vector<Complex>& x) {
  int settled = 0;
  for (std::size_t k = 0; k < x.size(); ++k)
    if (std::abs(x[k]) > 0.02) settled = static_cast<int>(k) + 1;
  return settled;
}

const std::vector<LinearMode> kModes = {
    {2.0, 1.0},         {1.0, 4.0},
    {5.0, 1.0},         {0.6, 3.0},
    {2.0, {2.0, 1.5}},  {{1.0, 0.4}, {2.0, 0.5}},
    {1.5, 1.0, 2, 1.0}, {{0.7, -0.3}, {1.5, 0.2}, 2, 1.0},
    {0.0, 1.3, 1},      {0.0, {1.0, 2.0}, 1},
};

TEST(Modes, OfRealStiffnessDecayWithAnyDamping) {
  EXPECT_TRUE(Decays({0.1, 4.0}));
  EXPECT_FALSE(Decays({0.0, 4.0}));
  EXPECT_FALSE(Decays({1.0, 0.0}));
  EXPECT_FALSE(Decays({1.0, -1.0}));
}

TEST(Modes, OfComplexStiffnessNeedDampingAboveItsImaginaryPartOverTheRootOfItsRealPart) {
  EXPECT_DOUBLE_EQ(MinDamping(1, 0, {4.0, 3.0}), 1.5);
  EXPECT_DOUBLE_EQ(MinDamping(4, 0, {1.0, 0.75}), 1.5);
  EXPECT_TRUE(Decays({1.51, {4.0, 3.0}}));
  EXPECT_FALSE(Decays({1.49, {4.0, 3.0}}));
}

TEST(Modes, OfADirectedCycleOfTenNeedTheRelativeDampingOfRenAndAtkins) {
  double least = 0;
  for (int k = 1; k < 10; ++k)
    least = std::max(least, MinRelativeDamping(1, 0, 1.0 - std::polar(1.0, 2 * std::numbers::pi * k / 10)));
  EXPECT_NEAR(least, 2.1763, 5e-5);
}

TEST(Modes, DecayIffEitherGainIsAboveItsLeastValue) {
  for (const Complex lambda : {Complex(1.0, 0.9), {0.2, -0.6}, {3.0, 0.0}, {0.5, 2.0}}) {
    for (const double p : {0.3, 1.0, 4.0}) {
      for (const double other : {0.0, 0.2, 1.0}) {
        const double g = MinRelativeDamping(p, other, lambda), b = MinDamping(p, other, lambda);
        EXPECT_TRUE(Decays({other + (g + 1e-6) * lambda, p * lambda}));
        EXPECT_TRUE(Decays({b + 1e-6 + other * lambda, p * lambda}));
        if (g > 0) {
          EXPECT_FALSE(Decays({other + g * (1 - 1e-6) * lambda, p * lambda}));
        }
        if (b > 0) {
          EXPECT_FALSE(Decays({b * (1 - 1e-6) + other * lambda, p * lambda}));
        }
      }
    }
  }
}

TEST(Modes, SampledDecayExactlyWhileStiffnessTimesPeriodIsBelowTwiceTheDamping) {
  // The second condition is damping * period < 2; both follow from the Jury test.
  EXPECT_TRUE(DecaysSampled({1.0, 20.0}, 0.0999));
  EXPECT_FALSE(DecaysSampled({1.0, 20.0}, 0.1001));
  EXPECT_TRUE(DecaysSampled({10.0, 1.0}, 0.1999));
  EXPECT_FALSE(DecaysSampled({10.0, 1.0}, 0.2001));
  const std::array<LinearMode, 2> modes = {{{1.0, 2.0}, {1.0, 20.0}}};
  EXPECT_NEAR(LongestPeriod(modes), 0.1, 1e-9);
  EXPECT_EQ(LongestPeriod(std::span<const LinearMode>()), std::numeric_limits<double>::infinity());
}

TEST(Modes, OfOrderOneDecayUpToTwiceTheRealPartOverTheSquaredMagnitude) {
  const LinearMode mode{0.0, {1.0, 2.0}, 1};
  EXPECT_DOUBLE_EQ(LongestPeriod({&mode, 1}), 2.0 / 5.0);
}

TEST(Modes, DecayBelowTheirLongestPeriodAndNotJustAboveIt) {
  for (const LinearMode& mode : kModes) {
    const double longest_s = LongestPeriod({&mode, 1});
    for (const double part : {0.01, 0.1, 0.5, 0.9, 0.99}) {
      const auto x = FromRest(mode, part * longest_s, 20000);
      EXPECT_LT(std::abs(x.back()), 1e-3) << mode.damping << " " << mode.stiffness << " " << part;
    }
    EXPECT_GT(std::abs(FromRest(mode, 1.01 * longest_s, 20000).back()), 1e3) << mode.damping << " " << mode.stiffness;
  }
}

TEST(Modes, SettleInTheTickInWhichTheirRecursionFromRestStaysWithinTwoPercent) {
  for (const LinearMode& mode : kModes) {
    for (const double part : {0.002, 0.05, 0.3}) {
      const double h = part * LongestPeriod({&mode, 1});
      const int witness = Settled(FromRest(mode, h, 60000));
      EXPECT_NEAR(SettlingTime(mode, h), witness * h, 1e-3 * witness * h + 1e-9)
          << mode.damping << " " << mode.stiffness << " " << part;
    }
  }
  EXPECT_NEAR(SettlingTime({2.0, 1.0}, 1e-4), 5.834, 0.01);                              // (1 + t) e^-t = 0.02
  EXPECT_NEAR(SettlingTime({1000.0, 1.0}, 1e-3), 1000 * std::log(50), 0.01 * 1000 * 4);  // stiff: one slow root
}

TEST(Modes, SettleTogetherWithTheLastOfThem) {
  const std::array<LinearMode, 3> modes = {{{1.0, 9.0}, {1.0, 0.1}, {1.0, 1.0}}};
  EXPECT_EQ(SettlingTime(modes, 0.01), SettlingTime(modes[1], 0.01));
}

TEST(Modes, DecayAtTheRateAtWhichTheirRecursionDoes) {
  for (const LinearMode& mode : kModes) {
    const double h = 0.1 * LongestPeriod({&mode, 1});
    const double rate = DecayRate({&mode, 1}, h);
    // Compare the largest |x| in two windows that are longer than an oscillation.
    const auto x = FromRest(mode, h, 4000);
    const auto largest = [&](int from) {
      double most = 0;
      for (int k = from; k < from + 200; ++k) most = std::max(most, std::abs(x[static_cast<std::size_t>(k)]));
      return most;
    };
    EXPECT_NEAR(std::log(largest(100) / largest(500)) / (400 * h), rate, 0.05 * rate)
        << mode.damping << " " << mode.stiffness;
  }
}

TEST(Modes, ScaledGainsScaleTheRate) {
  // Time scaled by 1 / c: damping is multiplied by c = 3, stiffness by c^2.
  const LinearMode mode{{1.0, 0.4}, {2.0, 0.5}}, fast{{3.0, 1.2}, {18.0, 4.5}};
  EXPECT_NEAR(DecayRate({&fast, 1}, 0.001), 3 * DecayRate({&mode, 1}, 0.003), 1e-9);
  EXPECT_NEAR(*OwnDelayMargin(fast, 0.001), *OwnDelayMargin(mode, 0.003) / 3, 1e-12);
}

TEST(Modes, OfOrderOneTolerateADelayOfPiOverTwiceTheirStiffness) {
  EXPECT_NEAR(*OwnDelayMargin({0.0, 3.618034, 1}, 1e-6), 0.43416, 1e-5);
}

/// Whether the sampled mode decays with all states known `late` ticks late: by the eigenvalues of its recursion.
bool DecaysLate(const LinearMode& mode, double h, int late) {
  const Eigen::Index size = 2 * (late + 1);  // x, v now, then of 1, 2, ... ticks ago
  Eigen::MatrixXcd map = Eigen::MatrixXcd::Zero(size, size);
  const bool first = mode.order == 1;
  map(0, 0) = 1;
  if (!first) map(0, 1) = h, map(1, 1) = 1;
  for (const auto& [row, share] : {std::pair(0, first ? h : mode.hold * h * h), {1, first ? 1 : h}}) {
    map(row, size - 2) -= share * mode.stiffness;
    if (!first) map(row, size - 1) -= share * mode.damping;
  }
  if (late > 0) map.bottomLeftCorner(size - 2, size - 2).setIdentity();
  return Eigen::VectorXcd(map.eigenvalues()).cwiseAbs().maxCoeff() < 1;
}

TEST(Modes, TolerateADelayOfAllStatesUpToTheirMarginToTheTick) {
  int known = 0;
  for (LinearMode mode : kModes)
    for (const double h : {0.3, 0.1, 0.03})
      for (const double hold : {0.5, 1.0}) {
        mode.hold = hold;
        const auto margin_s = OwnDelayMargin(mode, h);
        if (!DecaysSampled(mode, h) || !margin_s) continue;
        const int ticks = static_cast<int>(std::lround(*margin_s / h));
        if (ticks > 150) continue;
        EXPECT_NEAR(*margin_s, ticks * h, 1e-12);
        EXPECT_TRUE(DecaysLate(mode, h, ticks - 1)) << mode.damping << mode.stiffness << " " << h << " " << ticks;
        EXPECT_FALSE(DecaysLate(mode, h, ticks)) << mode.damping << mode.stiffness << " " << h << " " << ticks;
        ++known;
      }
  EXPECT_GT(known, 20);
}

TEST(Modes, HaveNoMarginWhereTheLoopGainAtHalfTheSamplingRateIsOne) {
  EXPECT_TRUE(OwnDelayMargin({0.0, 1.99, 1}, 1.0));
  EXPECT_FALSE(OwnDelayMargin({0.0, 2.0, 1}, 1.0));
  EXPECT_TRUE(OwnDelayMargin({1.99, 0.5, 2}, 1.0));
  EXPECT_FALSE(OwnDelayMargin({2.0, 0.5, 2}, 1.0));
}

}  // namespace
}  // namespace mascot
