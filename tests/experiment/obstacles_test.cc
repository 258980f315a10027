// Where obstacles are: nearest points and distances against closed forms and brute force; what a range sensor sees.
#include "experiment/obstacles.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "agent/agent.h"
#include "agent/laws/laws.h"
#include "base/random.h"

namespace mascot {
namespace {

using ::testing::IsEmpty;

const Obstacle kBox{.shape = Shape::kBox, .p_W = {1, 2, 3}, .size_m = {4, 2, 1}, .heading_rad = 0.5};
const Obstacle kSphere{.shape = Shape::kSphere, .p_W = {-1, 0, 2}, .size_m = {3, 3, 3}, .heading_rad = 0};
const Obstacle kCylinder{.shape = Shape::kCylinder, .p_W = {0, -2, 1}, .size_m = {2, 2, 5}, .heading_rad = 1};

/// Points all over the obstacle, its surface included, a few centimetres apart.
std::vector<Eigen::Vector3d> PointsOf(const Obstacle& obstacle) {
  constexpr int kSteps = 40;
  const Eigen::AngleAxisd to_W(obstacle.heading_rad, Eigen::Vector3d::UnitZ());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j)
      for (int k = 0; k <= kSteps; ++k) {
        // In the unit cube, then in the unit cylinder or ball, by shells.
        Eigen::Vector3d p = Eigen::Vector3d(i, j, k) * 2 / kSteps - Eigen::Vector3d::Ones();
        if (obstacle.shape == Shape::kSphere && p.norm() > 0) p *= p.cwiseAbs().maxCoeff() / p.norm();
        if (obstacle.shape == Shape::kCylinder && p.head<2>().norm() > 0)
          p.head<2>() *= p.head<2>().cwiseAbs().maxCoeff() / p.head<2>().norm();
        points.push_back(obstacle.p_W + to_W * (p.cwiseProduct(obstacle.size_m) / 2));
      }
  return points;
}

Eigen::Vector3d Somewhere(Random& random) { return {random.In(-6, 6), random.In(-6, 6), random.In(-6, 6)}; }

double DistanceTo(const Obstacle& obstacle, const Eigen::Vector3d& p_W) {
  return (NearestPoint_W(obstacle, p_W) - p_W).norm();
}

TEST(Obstacles, NearestPointsMoveAsTheirDerivativeSays) {
  Random random(7, Random::Stream::kPositions);
  for (const Obstacle& obstacle : {kBox, kSphere, kCylinder})
    for (int n = 0; n < 300; ++n) {
      const Eigen::Vector3d p_W = Somewhere(random), v_W = Somewhere(random) / 3;
      constexpr double kMoment_s = 1e-5;  // in it, all but a few points pass no edge
      const Eigen::Vector3d way_W =
          NearestPoint_W(obstacle, p_W + kMoment_s * v_W) - NearestPoint_W(obstacle, p_W - kMoment_s * v_W);
      EXPECT_LT((VelocityOfNearest_W(obstacle, p_W, v_W) - way_W / (2 * kMoment_s)).norm(), 1e-8) << n;
    }
  Obstacle far = kSphere;  // where a difference of two points would leave five digits of a velocity
  far.p_W.x() = 1e5;
  EXPECT_LT((VelocityOfNearest_W(far, {1e5, 4, 2}, {3, 1, 0}) - Eigen::Vector3d(1.5 / 4 * 3, 0, 0)).norm(), 1e-12);
}

TEST(Obstacles, NearestPointsAreTheClosedFormsOnFacesEdgesAndRound) {
  const Obstacle box{.shape = Shape::kBox, .p_W = {0, 0, 0}, .size_m = {2, 4, 6}, .heading_rad = 0};
  EXPECT_EQ(NearestPoint_W(box, {5, 0.5, -1}), Eigen::Vector3d(1, 0.5, -1)) << "a face";
  EXPECT_EQ(NearestPoint_W(box, {5, 7, -1}), Eigen::Vector3d(1, 2, -1)) << "an edge";
  EXPECT_EQ(NearestPoint_W(box, {5, 7, -9}), Eigen::Vector3d(1, 2, -3)) << "a corner";
  Obstacle turned = box;
  turned.heading_rad = std::numbers::pi / 2;
  EXPECT_LT((NearestPoint_W(turned, {5, 0.5, -1}) - Eigen::Vector3d(2, 0.5, -1)).norm(), 1e-12) << "a quarter turn";
  EXPECT_LT((NearestPoint_W(kSphere, {-1, 4, 2}) - Eigen::Vector3d(-1, 1.5, 2)).norm(), 1e-12);
  EXPECT_LT((NearestPoint_W(kCylinder, {3, -2, 2}) - Eigen::Vector3d(1, -2, 2)).norm(), 1e-12) << "its mantle";
  EXPECT_LT((NearestPoint_W(kCylinder, {0.2, -2, 9}) - Eigen::Vector3d(0.2, -2, 3.5)).norm(), 1e-12) << "its top";
  EXPECT_LT((NearestPoint_W(kCylinder, {3, -2, 9}) - Eigen::Vector3d(1, -2, 3.5)).norm(), 1e-12) << "its rim";
}

TEST(Obstacles, APointInsideIsItsOwnNearest) {
  for (const Obstacle& obstacle : {kBox, kSphere, kCylinder}) {
    const Eigen::Vector3d inside_W = obstacle.p_W + Eigen::Vector3d(0.1, -0.2, 0.3);
    EXPECT_EQ(NearestPoint_W(obstacle, inside_W), inside_W);
  }
}

TEST(Obstacles, NoPointOfABodyIsNearerThanItsNearest) {
  Random random(1, Random::Stream::kPositions);
  for (const Obstacle& obstacle : {kBox, kSphere, kCylinder}) {
    const std::vector<Eigen::Vector3d> points = PointsOf(obstacle);
    for (int n = 0; n < 20; ++n) {
      const Eigen::Vector3d p_W = Somewhere(random);
      double min_m = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& point : points) min_m = std::min(min_m, (point - p_W).norm());
      EXPECT_LE(DistanceTo(obstacle, p_W), min_m + 1e-12);
      EXPECT_NEAR(DistanceTo(obstacle, p_W), min_m, 0.1) << "as near as the grid is fine";
    }
  }
}

TEST(Obstacles, AWayComesAsNearAsItsNearestPoint) {
  Random random(2, Random::Stream::kPositions);
  for (const Obstacle& obstacle : {kBox, kSphere, kCylinder})
    for (int n = 0; n < 50; ++n) {
      const Eigen::Vector3d a_W = Somewhere(random), b_W = Somewhere(random);
      double min_m = std::numeric_limits<double>::infinity();
      for (int k = 0; k <= 1000; ++k) min_m = std::min(min_m, DistanceTo(obstacle, a_W + k / 1000.0 * (b_W - a_W)));
      EXPECT_LE(DistanceOfWay_m(obstacle, a_W, b_W), min_m + 1e-9);
      EXPECT_NEAR(DistanceOfWay_m(obstacle, a_W, b_W), min_m, (b_W - a_W).norm() / 2000 + 1e-9);
    }
  EXPECT_NEAR(DistanceOfWay_m(kSphere, {-9, 0, 2}, {9, 0, 2}), 0, 1e-12) << "through it";
  EXPECT_NEAR(DistanceOfWay_m(kSphere, {-9, 4, 2}, {9, 4, 2}), 2.5, 1e-9) << "past it";
  EXPECT_NEAR(DistanceOfWay_m(kSphere, {-9, 0, 2}, {-4, 0, 2}), 1.5, 1e-9) << "it ends before";
  EXPECT_NEAR(DistanceOfWay_m(kSphere, {-4, 0, 2}, {-4, 0, 2}), 1.5, 1e-9) << "of no length";
}

TEST(Obstacles, AreAsFarApartAsTheirNearestPoints) {
  Obstacle other = kSphere;
  other.p_W = {-1, 6, 2};
  EXPECT_NEAR(Distance_m(kSphere, other), 3, 1e-9) << "6 m between centres of two spheres of radius 1.5";
  EXPECT_EQ(Distance_m(kSphere, kSphere), 0) << "they meet";
  Obstacle wall{.shape = Shape::kBox, .p_W = {4, 0, 0}, .size_m = {1, 20, 20}, .heading_rad = 0};
  EXPECT_NEAR(Distance_m(wall, kCylinder), 2.5, 1e-9) << "3.5 less the radius of 1";
  EXPECT_NEAR(Distance_m(kCylinder, wall), 2.5, 1e-9) << "whichever comes first";
  wall.heading_rad = std::numbers::pi / 4;
  EXPECT_NEAR(Distance_m(wall, kCylinder), std::hypot(4, 2) * std::cos(std::atan2(2, 4) - std::numbers::pi / 4) - 1.5,
              1e-6)
      << "of the plane of a turned face";
  wall.p_W = {40, 0, 0};
  wall.size_m = {1, 2, 2};
  double min_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : PointsOf(wall)) min_m = std::min(min_m, DistanceTo(kBox, point));
  EXPECT_NEAR(Distance_m(wall, kBox), min_m, 1e-6) << "of two boxes: a corner is among the points";
}

TEST(RangeSensor, SeesTheNearestPointOfEachObstacleInRangeInTheirOrder) {
  RangeSensor sensor(4.0, {kSphere, kCylinder, kBox});
  const Eigen::Vector3d p_W(-1, 4, 2);
  const std::span<const Eigen::Vector3d> seen = sensor.Sense(p_W);
  ASSERT_EQ(seen.size(), 2u) << "the cylinder is " << DistanceTo(kCylinder, p_W) << " m away";
  EXPECT_EQ(seen[0], NearestPoint_W(kSphere, p_W));
  EXPECT_EQ(seen[1], NearestPoint_W(kBox, p_W));
  EXPECT_THAT(sensor.Sense({-50, 0, 2}), IsEmpty());
  const Eigen::Vector3d inside_W(-1, 0, 2.5);
  EXPECT_EQ(sensor.Sense(inside_W)[0], inside_W) << "inside of one it sees itself";
}

/// What the law of agent 1 sees at the true position [2.5, 0, 1], a metre from one sphere and far from another, as the
/// acceleration that it wants: what it sees, or (9, 9, 9) if that is not one point.
Eigen::Vector3d Seen(const std::string& sensors) {
  const std::string text = "[run]\nduration_s = 1\n[agents]\ncount = 1\nposition_m = [[5, 5, 1]]\n[sensors]\n" +
                           sensors +
                           "[[physics.obstacles]]\nshape = 'sphere'\nposition_m = [0, 0, 1]\nsize_m = [3, 3, 3]\n"
                           "[[physics.obstacles]]\nshape = 'sphere'\nposition_m = [50, 0, 1]\nsize_m = [3, 3, 3]\n"
                           "[law]\nname = 'custom'\naxes = 'xyz'\npython = '''\n"
                           "def control(t, me, neighbours):\n"
                           "  assert me.ranges.shape == (len(me.ranges), 3)\n"
                           "  return me.ranges[0] if len(me.ranges) == 1 else [9, 9, 9]\n'''\n";
  const Experiment experiment = LoadExperiment(Section::FromText(text, "test.toml"), "test");
  Agent agent(experiment, 1);
  Motion self;
  self.p_WB = {2.5, 0, 1};
  return agent.Want(0, self, {}).a_law_W;
}

TEST(RangeSensor, IsWhatALawInPythonSees) {
  const Eigen::Vector3d nothing(9, 9, 9);
  EXPECT_EQ(Seen(""), nothing) << "no range: no sensor";
  EXPECT_EQ(Seen("range_m = 0.9\n"), nothing);
  EXPECT_EQ(Seen("range_m = 1.1\n"), Eigen::Vector3d(1.5, 0, 1)) << "a point in W";
  EXPECT_EQ(Seen("range_m = 50.0\n"), nothing) << "both spheres";
}

TEST(RangeSensor, SeesFromWhereTheAgentBelievesToBe) {
  const Eigen::Vector3d seen_W = Seen("range_m = 2.0\nown = { position_bias_std_m = 0.1 }\n");
  EXPECT_NE(seen_W, Eigen::Vector3d(1.5, 0, 1));
  EXPECT_NEAR((seen_W - Eigen::Vector3d(0, 0, 1)).norm(), 1.5, 1e-12) << "still a point of the sphere";
}

}  // namespace
}  // namespace mascot
