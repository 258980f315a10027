// The smallest distances, beside those of all pairs.
#include "orchestrator/measuring/separation.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace mascot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Separation, IsInfiniteForOneAgent) {
  Separation separation;
  separation.Add(std::vector<Motion>(1), std::vector<Axes>(1, Axes::kXy));
  EXPECT_EQ(separation.in_space_m(), kInfinity);
  EXPECT_EQ(separation.along_axes_m(), kInfinity);
}

TEST(Separation, IsThatOfAllPairsAndTicks) {
  std::mt19937_64 random(1);
  int closer_in_plane = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t count = 2 + static_cast<std::size_t>(trial) % 9;
    // Long along one axis or another, and in some trials flat: then agents are level in a coordinate.
    Eigen::Vector3d size_m(2, 2, 2);
    size_m[trial % 3] = trial % 4 == 0 ? 0 : 30;
    std::normal_distribution<double> normal;
    const auto draw = [&](double scale) -> Eigen::Vector3d {
      return Eigen::Vector3d(normal(random), normal(random), normal(random)) * scale;
    };
    std::vector<Motion> motions(count);
    for (Motion& motion : motions) motion.p_WB = draw(1).cwiseProduct(size_m);
    std::vector<Axes> axes(count, Axes::kXyz);
    Separation separation;
    double in_space = kInfinity, along_axes = kInfinity;
    for (int tick = 0; tick < 100; ++tick) {
      if (tick == 50) size_m.setConstant(1);
      for (Motion& motion : motions) motion.p_WB += draw(0.05).cwiseProduct(size_m);
      if (tick % 10 == 0)
        for (Axes& each : axes) each = trial % 5 == 0 || normal(random) > 0.5 ? Axes::kXyz : Axes::kXy;
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const Eigen::Vector3d dp_W = motions[i].p_WB - motions[j].p_WB;
          const bool in_plane = axes[i] == Axes::kXy || axes[j] == Axes::kXy;
          in_space = std::min(in_space, dp_W.norm());
          along_axes = std::min(along_axes, in_plane ? dp_W.head<2>().norm() : dp_W.norm());
        }
      separation.Add(motions, axes);
      ASSERT_DOUBLE_EQ(separation.in_space_m(), in_space) << "trial " << trial << ", tick " << tick;
      ASSERT_DOUBLE_EQ(separation.along_axes_m(), along_axes) << "trial " << trial << ", tick " << tick;
    }
    closer_in_plane += along_axes < in_space;
  }
  EXPECT_GT(closer_in_plane, 20);
}

}  // namespace
}  // namespace mascot
