// Beta agents: what obstacles do to a flock, on one agent, on the law alone and in whole runs.
#include "agent/laws/flocking/beta_agents.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "base/random.h"
#include "tests/support/ideal_network.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;

const Obstacle kWall{.shape = Shape::kBox, .p_W = {5, 0, 0}, .size_m = {2, 40, 40}, .heading_rad = 0};
const Obstacle kBall{.shape = Shape::kSphere, .p_W = {1, 2, 3}, .size_m = {3, 3, 3}, .heading_rad = 0};

TEST(BetaAgents, FlyAlongWallsAsTheAgentDoesAndOnSpheresAsMuchSlowerAsTheseAreNarrower) {
  Random random(3, Random::Stream::kPositions);
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d v_W(random.In(-2, 2), random.In(-2, 2), random.In(-2, 2));
    const Eigen::Vector3d x_W(random.In(-3, 3.9), random.In(-9, 9), random.In(-9, 9));
    EXPECT_LT((VelocityOfNearest_W(kWall, x_W, v_W) - Eigen::Vector3d(0, v_W.y(), v_W.z())).norm(), 1e-12) << n;
    const Eigen::Vector3d way_W = x_W - kBall.p_W, a_W = way_W.normalized();
    if (way_W.norm() < 1.6) continue;
    const Eigen::Vector3d p_W = 1.5 / way_W.norm() * (v_W - a_W * a_W.dot(v_W));  // mu P v
    EXPECT_LT((VelocityOfNearest_W(kBall, x_W, v_W) - p_W).norm(), 1e-12) << n;
  }
}

TEST(BetaAgents, PushAsInThePaperAndNotFromTheirDistanceOn) {
  const BetaAgents beta{.distance_m = 1.2, .epsilon = 0.1, .c1 = 10, .c2 = 3, .obstacles = {}};
  const auto push_W = [&](double l, const Eigen::Vector3d& v_W) {
    Motion self;
    self.v_WB = v_W;
    return beta.PushOfOne_W(self, {l, 0, 0}, {0, v_W.y(), v_W.z()});
  };
  const double d_beta = (std::sqrt(1 + 0.1 * 1.44) - 1) / 0.1;
  for (const double l : {0.1, 0.6, 1.0}) {  // nearer than the share 0.9 of d_beta nothing fades
    const double z = (std::sqrt(1 + 0.1 * l * l) - 1) / 0.1, off = z - d_beta;
    const double phi = off / std::sqrt(1 + off * off) - 1;
    EXPECT_NEAR(push_W(l, {0, 0, 0}).x(), 10 * phi * l / std::sqrt(1 + 0.1 * l * l), 1e-12) << l;
    EXPECT_LT(push_W(l, {0, 0, 0}).x(), 0) << "away";
    EXPECT_NEAR(push_W(l, {2, 5, 1}).x() - push_W(l, {0, 0, 0}).x(), -3 * 2, 1e-12) << "the velocity towards it";
    EXPECT_EQ(push_W(l, {2, 5, 1}).y(), 0) << "that along it is not damped";
  }
  EXPECT_GT(push_W(1.199, {0, 0, 0}).norm(), 0);
  EXPECT_LT(push_W(1.199, {0, 0, 0}).norm(), 0.01) << "it fades";
  EXPECT_EQ(push_W(1.2, {2, 1, 1}), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(push_W(0, {0, 0, 0}), Eigen::Vector3d(0, 0, 0)) << "inside there is no direction";
}

/// Six agents that start near (-6, 0), with a target at (6, 0). `more`: tables; `law`: lines of [law].
std::string Six(const std::string& more, const std::string& law = "", std::uint64_t seed = 1,
                const std::string& model = "double_integrator") {
  Random random(seed, Random::Stream::kPositions);
  std::string positions, velocities;
  for (int n = 0; n < 6; ++n) {
    const int row = n / 2;
    positions += fmt::format("{}[{}, {}, 1.0]", n == 0 ? "" : ", ", -8 + 2 * (n % 2) + random.In(-0.4, 0.4),
                             -2 + 2 * row + random.In(-0.4, 0.4));
    velocities += fmt::format("{}[{}, {}, 0]", n == 0 ? "" : ", ", random.In(-1, 1), random.In(-1, 1));
  }
  return "[run]\nduration_s = 30\n[agents]\nmodel = '" + model + "'\ncount = 6\nposition_m = [" + positions +
         "]\nvelocity_m_per_s = [" + velocities + "]\n[control]\nmax_acceleration_m_per_s2 = 10\n" + more +
         "[law]\nname = 'flocking'\nc1_gamma = 0.2\ntarget_m = [6, 0, 1]\n" + law;
}
const std::string kThree =
    "[[physics.obstacles]]\nshape = 'sphere'\nposition_m = [-1, 0.8, 1]\nsize_m = [1.6, 1.6, 1.6]\n"
    "[[physics.obstacles]]\nshape = 'box'\nposition_m = [0.5, -3, 1]\nsize_m = [1, 1, 6]\nheading_rad = 0.5\n"
    "[[physics.obstacles]]\nshape = 'cylinder'\nposition_m = [1.5, 3.5, 1]\nsize_m = [1.2, 1.2, 6]\n";
const std::string kSight = "[sensors]\nrange_m = 2.0\n";

TEST(BetaAgents, KeepAFlockOutOfObstaclesThatItWouldFlyThrough) {
  double min_m = 1e9, blind_m = 1e9;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const bool sees : {true, false}) {
      IdealNetwork network(Six(kThree + (sees ? kSight : ""), "", seed));
      double& clearance_m = sees ? min_m : blind_m;
      while (network.time_s() < 30) {
        network.Step();
        for (const Motion& motion : network.motions)
          for (const Obstacle& obstacle : network.experiment.physics.obstacles)
            clearance_m = std::min(clearance_m, (NearestPoint_W(obstacle, motion.p_WB) - motion.p_WB).norm());
      }
      Eigen::Vector3d centre_W = Eigen::Vector3d::Zero();
      for (const Motion& motion : network.motions) centre_W += motion.p_WB / 6;
      EXPECT_GT(centre_W.x(), 3) << seed << ": it passes";
    }
  EXPECT_GT(min_m, 0.3);
  EXPECT_EQ(blind_m, 0) << "without seeing them it flies into them";
}

TEST(BetaAgents, ThatAreOutOfSightOrTooFarDoNotChangeABit) {
  const std::string far = "[[physics.obstacles]]\nshape = 'sphere'\nposition_m = [0, 30, 1]\nsize_m = [2, 2, 2]\n";
  IdealNetwork alone(Six("")), blind(Six(kThree)), away(Six(far + kSight)),
      seen(Six(far + "[sensors]\nrange_m = 100.0\n"));
  for (int n = 0; n < 1000; ++n) {
    for (IdealNetwork* network : {&alone, &blind, &away, &seen}) network->Step();
    for (std::size_t i = 0; i < 6; ++i)
      for (const IdealNetwork* network : {&blind, &away, &seen})
        ASSERT_EQ(network->motions[i].p_WB, alone.motions[i].p_WB) << n;
  }
}

TEST(BetaAgents, TurnAFlockOfBodiesAsideWithoutAContact) {
  for (const std::string model : {"double_integrator", "quadrotor"}) {
    const LawRun run(Six(kThree + kSight, "", 2, model));
    EXPECT_EQ(run.summary["safety"]["contacts"]["obstacles"], 0) << model;
    EXPECT_THAT(run.prediction.figures_silent + run.prediction.silent,
                model == "quadrotor" ? MatchesRegex("agents [13] and 4 may touch, 3\\.3[0-9]* s from the start")
                                     : MatchesRegex("obstacles push the agents that see them"))
        << "of two pairs that come near within 0.01 s, the compiler's rounding decides";
    EXPECT_LT(run.Measured("centre_off_m"), 4) << model;
  }
}

TEST(BetaAgents, ThatAFlockDoesNotSeeInTimeAreWarnedOf) {
  const auto warnings = [](const std::string& toml) {
    return Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test")).warnings;
  };
  EXPECT_THAT(warnings(Six(kThree)),
              ElementsAre("sensors.range_m: with 0, the default, the flock does not see the obstacles"));
  EXPECT_THAT(warnings(Six(kThree + "[sensors]\nrange_m = 1.0\n")),
              ElementsAre("sensors.range_m: the flock sees obstacles from 1.0 m on, nearer than "
                          "law.obstacle_distance_m = 1.2"));
  EXPECT_THAT(warnings(Six("[physics]\ncollisions = false\n" + kThree)), IsEmpty());
}

}  // namespace
}  // namespace mascot
