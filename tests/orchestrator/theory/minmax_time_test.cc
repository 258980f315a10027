#include "orchestrator/theory/minmax_time.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mascot {
namespace {

TEST(MinmaxTimes, FromRestAreThePublishedClosedForms) {
  EXPECT_NEAR(MinmaxTime(10, 0, 0.5, 1), 7.746, 1e-3);
  EXPECT_NEAR(MinmaxTime(-10, 0, 0.5, 1), 7.746, 1e-3);
  EXPECT_NEAR(MinmaxBound(10, 0, 0.5), 8.944, 1e-3);
  EXPECT_NEAR(MinmaxTime(20, 0, 0.05, 1), 28.98, 5e-3);
  EXPECT_NEAR(MinmaxTime(20, 0, 0.05, 0.6), 29.44, 5e-3);  // with beta cut at the published force limit
  EXPECT_EQ(MinmaxTime(0, 0, 0.5, 1), 0);
  EXPECT_EQ(MinmaxBound(0, 0, 0.5), 0);
}

TEST(MinmaxTimes, HoldFromAnyRelativeSpeed) {
  const double alpha = 0.5, beta = 2, h = 1e-5;
  for (const double z0 : {-6.0, -1.0, 0.0, 3.0}) {
    for (const double w0 : {-3.0, -1.0, 0.0, 0.5, 2.0, 4.0}) {
      double z = z0, w = w0, t = 0;
      while (std::abs(z) > 1e-4 || std::abs(w) > 0.01) {
        const double side = 2 * alpha * z + w * std::abs(w);
        w -= h * beta * ((side > 0) - (side < 0));
        z += h * w;
        t += h;
      }
      EXPECT_NEAR(MinmaxTime(z0, w0, alpha, beta), t, 0.03) << z0 << " " << w0;
      EXPECT_LE(MinmaxTime(z0, w0, alpha, beta), MinmaxBound(z0, w0, alpha) + 1e-9) << z0 << " " << w0;
    }
  }
}

}  // namespace
}  // namespace mascot
