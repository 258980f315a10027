// Bodies that are moved from outside: vehicles, as they were measured.
#include <gmock/gmock.h>

#include <vector>

#include "physics_server/world.h"
#include "tests/physics_server/one_body.h"

namespace mascot {
namespace {

using Eigen::Vector3d;

Experiment WithVehicle(std::string_view model, const std::vector<Vector3d>& p_W) {
  Experiment e = Bodies(model, p_W);
  e.agents[0].vehicle = VehicleConfig{};
  return e;
}

Motion At(const Vector3d& p_W, const Vector3d& v_W = Vector3d::Zero()) { return {.p_WB = p_W, .v_WB = v_W}; }

TEST(MovedBody, IsWhereItWasMeasuredWhateverItsCommandIs) {
  World world(WithVehicle("quadrotor", {{0, 0, 1}, {5, 0, 1}}));
  const std::vector<Actuation> commands(2, Actuation{900, 900, 900, 900});
  Vector3d v_before = Vector3d::Zero();
  for (int tick = 1; tick <= 20; ++tick) {
    Motion measured{.p_WB = {0.013 * tick, -0.02 * tick, 1 + 0.001 * tick},
                    .q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(0.05 * tick, Vector3d(1, 2, 3).normalized())),
                    .v_WB = {1.3, -2 + 0.1 * tick, 0.1},
                    .w_WB_B = {0.1, 0.2, 0.3 * tick}};
    world.Move(1, measured);
    world.Step(commands);
    const Motion state = world.State(1);
    EXPECT_EQ(state.p_WB, measured.p_WB);
    EXPECT_EQ(state.q_WB.coeffs(), measured.q_WB.coeffs());
    EXPECT_EQ(state.v_WB, measured.v_WB);
    EXPECT_EQ(state.w_WB_B, measured.w_WB_B);
    EXPECT_EQ(state.a_WB, ((measured.v_WB - v_before) * 100).eval());
    v_before = measured.v_WB;
  }
}

TEST(MovedBody, StaysWhereItIsWithoutANewPlace) {
  World world(WithVehicle("quadrotor", {{0, 0, 1}}));
  const std::vector<Actuation> commands(1);
  world.Step(commands);
  EXPECT_EQ(world.State(1).p_WB, Vector3d(0, 0, 1)) << "it does not fall";
  world.Move(1, At({0.1, 0, 1}));
  for (int tick = 0; tick < 10; ++tick) world.Step(commands);
  EXPECT_EQ(world.State(1).p_WB, Vector3d(0.1, 0, 1));
}

TEST(MovedBody, BeginsWhereItWasMeasured) {
  World world(WithVehicle("quadrotor", {{0, 0, 1}}));
  const Motion measured = At({0.1, -0.2, 1.05}, {0, 0.1, 0});
  world.Place(1, measured);
  EXPECT_EQ(world.State(1).p_WB, measured.p_WB);
  EXPECT_EQ(world.State(1).v_WB, measured.v_WB);
  world.Step(std::vector<Actuation>(1));
  EXPECT_EQ(world.State(1).p_WB, measured.p_WB);
  EXPECT_EQ(world.State(1).a_WB, Vector3d::Zero());
}

TEST(MovedBody, PushesOthersAsideAndIsNotPushed) {
  World world(WithVehicle("double_integrator", {{0, 0, 1}, {1, 0, 1}}));
  const std::vector<Actuation> commands(2);
  for (int tick = 1; tick <= 200; ++tick) {
    world.Move(1, At({0.01 * tick, 0, 1}, {1, 0, 0}));
    world.Step(commands);
    EXPECT_EQ(world.State(1).p_WB, Vector3d(0.01 * tick, 0, 1));
    EXPECT_GE((world.State(2).p_WB - world.State(1).p_WB).norm(), 2 * kBallRadius_m - 0.02);
  }
  EXPECT_GT(world.State(2).p_WB.x(), 2.1);
  EXPECT_GE(world.collisions(), 1);
}

TEST(MovedBody, ThatJumpsHitsNothingBetween) {
  World world(WithVehicle("double_integrator", {{0, 0, 1}, {1, 0, 1}}));
  const std::vector<Actuation> commands(2);
  world.Move(1, At({3, 0, 1}));
  world.Step(commands);
  world.Step(commands);
  EXPECT_EQ(world.State(2).p_WB, Vector3d(1, 0, 1));
  EXPECT_EQ(world.collisions(), 0);
}

TEST(MovedBody, StandsOnTheGroundWithoutTouchingIt) {
  World world(WithVehicle("quadrotor", {{0, 0, 0.01}}));
  for (int tick = 0; tick < 10; ++tick) world.Step(std::vector<Actuation>(1));
  EXPECT_EQ(world.collisions(), 0);
  EXPECT_EQ(world.State(1).p_WB, Vector3d(0, 0, 0.01));
}

TEST(MovedBody, ChangesNoBitOfTheOthers) {
  const std::vector<Vector3d> p_W = {{0, 0, 1}, {1, 0, 2}, {-1, 0.5, 1}};
  World with(WithVehicle("quadrotor", p_W)), without(Bodies("quadrotor", p_W));
  for (int tick = 1; tick <= 100; ++tick) {
    const double speed = 800 + tick;
    const std::vector<Actuation> commands(3, Actuation{speed, speed + 1, speed, speed - 1});
    with.Move(1, At({0, 0, 1 + 0.001 * tick}));
    with.Step(commands);
    without.Step(commands);
    for (const int id : {2, 3}) {
      EXPECT_EQ(with.State(id).p_WB, without.State(id).p_WB);
      EXPECT_EQ(with.State(id).q_WB.coeffs(), without.State(id).q_WB.coeffs());
    }
  }
}

}  // namespace
}  // namespace mascot
