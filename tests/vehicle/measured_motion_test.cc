#include "vehicle/measured_motion.h"

#include <gtest/gtest.h>

#include <limits>

namespace mascot {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();

TEST(MeasuredMotion, OfFloatsIsGood) {
  EXPECT_EQ(WhyNotMeasured(Motion{}), "");
  EXPECT_EQ(WhyNotMeasured({.p_WB = {100, -200, 30}, .q_WB = {0.7071F, 0, 0, 0.7072F}, .v_WB = {20, 0, -5}}), "");
}

TEST(MeasuredMotion, WithoutANumberOrBeyondReasonIsRefusedInWords) {
  for (const double wrong : {kNan, kInfinite, -kInfinite, 1e7, -1e300})
    for (int axis = 0; axis < 3; ++axis) {
      Motion position, velocity, turning;
      position.p_WB[axis] = velocity.v_WB[axis] = turning.w_WB_B[axis] = wrong;
      EXPECT_EQ(WhyNotMeasured(position), "its position is unknown") << wrong;
      EXPECT_EQ(WhyNotMeasured(velocity), "its velocity is unknown") << wrong;
      EXPECT_EQ(WhyNotMeasured(turning), "its velocity is unknown") << wrong;
    }
  for (const Eigen::Quaterniond& q : {Eigen::Quaterniond(0, 0, 0, 0), Eigen::Quaterniond(kNan, 0, 0, 0),
                                      Eigen::Quaterniond(2, 0, 0, 0), Eigen::Quaterniond(0, kInfinite, 0, 0)})
    EXPECT_EQ(WhyNotMeasured({.q_WB = q}), "its orientation is unknown");
}

}  // namespace
}  // namespace mascot
