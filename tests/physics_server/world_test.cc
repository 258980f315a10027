#include "physics_server/world.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>

#include "physics_server/model.h"
#include "tests/physics_server/one_body.h"

namespace mascot {
namespace {

using Eigen::Vector3d;
using ::testing::ThrowsMessage;

constexpr double kG = 9.81;

Actuation Rotors(double all) { return {all, all, all, all}; }

/// Steps a world of one body `ticks` times with one command.
void Fly(World& world, const Actuation& command, int ticks) {
  for (int i = 0; i < ticks; ++i) world.Step(std::array<Actuation, 1>{command});
}

/// Orientation of a body with this yaw.
Eigen::Quaterniond Turned(double yaw_rad) { return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ())); }

// --- initial states ---------------------------------------------------------------------------------

TEST(MakeModel, HasABodyForEveryModelAsItsTraitsSay) {
  for (const ModelTraits& traits : Models()) {
    const Experiment e = Bodies(traits.name, {{0, 0, 1}});
    const auto model = MakeModel(e, 1);
    EXPECT_EQ(model->feels_gravity(), traits.has_airframe) << traits.name;
    EXPECT_EQ(model->touches_ground(), !traits.rolls) << traits.name;
    const Vector3d box_m = traits.has_airframe ? (e.agent(1).size_m() / 2).eval() : Vector3d::Zero().eval();
    EXPECT_EQ(model->half_size_m(), box_m) << traits.name;
  }
}

TEST(World, StartsExactlyAsConfigured) {
  for (const ModelTraits& model : Models()) {
    Experiment e = Bodies(model.name, {{0.1, 0.2, 1.3}, {1.0 / 3, -7, 2}});
    e.agents[1].v_W = {0.7, -0.1, 1e-9};
    e.agents[1].heading_rad = -2.5;
    const World world(e);
    EXPECT_EQ(world.tick(), 0);
    EXPECT_EQ(world.collisions(), 0);
    for (const AgentConfig& agent : e.agents) {
      const Motion state = world.State(agent.id);
      EXPECT_EQ(state.p_WB, agent.p_W);
      EXPECT_EQ(state.v_WB, agent.v_W);
      EXPECT_EQ(state.q_WB.coeffs(), Turned(agent.heading_rad).coeffs());
      EXPECT_EQ(state.w_WB_B, Vector3d::Zero().eval());
      EXPECT_EQ(state.a_WB, Vector3d::Zero().eval());
    }
  }
}

TEST(World, DrivesABodyAlongItsInitialHeading) {
  Experiment e = Bodies("quadrotor", {{0, 0, 10}});
  e.agents[0].heading_rad = std::numbers::pi / 2;
  World world(e);
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  Fly(world, {0.99 * hover, hover, 1.01 * hover, hover}, 20);  // nose down; the nose points north
  EXPECT_GT(world.State(1).v_WB.y(), 1e-3);
  EXPECT_NEAR(world.State(1).v_WB.x(), 0, 1e-6);
}

// --- translation ------------------------------------------------------------------------------------

TEST(World, LetsABodyFallAsGalileoSays) {
  World world(Bodies("quadrotor", {{0, 0, 100}}, WithoutDrag()));
  Fly(world, Rotors(0), 200);
  const double t = 2.0;
  EXPECT_NEAR(world.State(1).p_WB.z(), 100 - kG * t * t / 2, 1e-9);
  EXPECT_NEAR(world.State(1).v_WB.z(), -kG * t, 1e-9);
  EXPECT_NEAR(world.State(1).a_WB.z(), -kG, 1e-9);
}

TEST(World, KeepsAQuadrotorWhereItHoversForAMinute) {
  World world(Bodies("quadrotor", {{1, 2, 3}}));
  Fly(world, Rotors(Built("mascot").HoverRotorSpeed(kG)), 6000);
  EXPECT_LT((world.State(1).p_WB - Vector3d(1, 2, 3)).norm(), 1e-9);
  EXPECT_LT(world.State(1).v_WB.norm(), 1e-10);
}

TEST(World, FallsNoFasterThanWeightOverDrag) {
  Airframe body = Built("mascot");
  body.linear_drag_kg_per_s = 2;
  Experiment e = Bodies("quadrotor", {{0, 0, 1000}}, body);
  e.agents[0].v_W = {10, 0, 0};
  World world(e);
  Fly(world, Rotors(0), 3000);
  EXPECT_NEAR(world.State(1).v_WB.z(), -body.mass_kg * kG / 2, 1e-6);
  EXPECT_NEAR(world.State(1).v_WB.x(), 0, 1e-6);
}

TEST(World, MovesADoubleIntegratorByTheZeroOrderHoldRecursion) {
  Experiment e = Bodies("double_integrator", {{1, -2, 3}});
  e.agents[0].v_W = {0.5, 0.25, 0};
  World world(e);
  std::mt19937_64 random(1);
  Vector3d p = e.agents[0].p_W, v = e.agents[0].v_W;
  const double h = e.period_s();
  for (int tick = 0; tick < 4000; ++tick) {
    Vector3d u;
    for (double& component : u) component = static_cast<double>(random() >> 11) * 0x1p-52 - 1;  // in [-1, 1)
    p += h * v + h * h / 2 * u;
    v += h * u;
    Fly(world, {u.x(), u.y(), u.z() + 0.5 * (3 - p.z()) - v.z(), 0}, 1);  // keep z off the ground
    p.z() = world.State(1).p_WB.z();
    v.z() = world.State(1).v_WB.z();
    ASSERT_LT((world.State(1).p_WB - p).norm(), 1e-9) << "tick " << tick;
    ASSERT_LT((world.State(1).v_WB - v).norm(), 1e-10) << "tick " << tick;
  }
}

TEST(World, AppliesGravityOnlyToModelsThatHaveIt) {
  Experiment e = Bodies("double_integrator", {{0, 0, 1}, {5, 0, 50}});
  e.agents[1].model = "quadrotor";
  World world(e);
  for (int i = 0; i < 100; ++i) world.Step(std::array<Actuation, 2>{Rotors(0), Rotors(0)});
  EXPECT_EQ(world.State(1).p_WB, Vector3d(0, 0, 1));
  EXPECT_LT(world.State(2).v_WB.z(), -9);
}

TEST(World, MovesABodyThatRestedForLong) {
  World world(Bodies("double_integrator", {{0, 0, 1}}));
  Fly(world, Rotors(0), 1000);
  Fly(world, {1e-3, 0, 0, 0}, 100);
  EXPECT_NEAR(world.State(1).v_WB.x(), 1e-3, 1e-12);
}

TEST(World, GivesTheMeanAccelerationOfTheLastTick) {
  World world(Bodies("double_integrator", {{0, 0, 1}}));
  Fly(world, {2, 0, 0, 0}, 1);
  EXPECT_NEAR(world.State(1).a_WB.x(), 2, 1e-12);
  Fly(world, {-1, 0.5, 0, 0}, 1);
  EXPECT_NEAR(world.State(1).a_WB.x(), -1, 1e-12);
  EXPECT_NEAR(world.State(1).a_WB.y(), 0.5, 1e-12);
}

// --- driven by velocity -----------------------------------------------------------------------------

TEST(World, MovesASingleIntegratorByExactlyItsVelocityInEveryTick) {
  for (const int physics_rate_hz : {100, 1000, 3000}) {
    Experiment e = Bodies("single_integrator", {{1, -2, 3}});
    e.physics.rate_hz = physics_rate_hz;
    e.agents[0].v_W = {9, 9, 9};  // initial velocity, before the first command
    World world(e);
    std::mt19937_64 random(1);
    Vector3d p = e.agents[0].p_W;
    for (int tick = 0; tick < 1000; ++tick) {
      Vector3d v;
      for (double& component : v) component = static_cast<double>(random() >> 11) * 0x1p-52 - 1;  // in [-1, 1)
      v.z() += 3 - p.z();  // keep it off the ground
      p += e.period_s() * v;
      Fly(world, {v.x(), v.y(), v.z(), 0}, 1);
      ASSERT_LT((world.State(1).p_WB - p).norm(), 1e-12) << "tick " << tick << " at " << physics_rate_hz << " Hz";
      ASSERT_EQ(world.State(1).v_WB, v);
    }
    EXPECT_EQ(world.State(1).q_WB.coeffs(), Turned(0).coeffs());
  }
}

/// Position of a unicycle after t_s with constant speed v (m/s) and turn rate w (rad/s).
Vector3d OnArc(const AgentConfig& start, double v, double w, double t_s) {
  const double a = start.heading_rad, b = a + w * t_s;
  return start.p_W + v / w * Vector3d(std::sin(b) - std::sin(a), std::cos(a) - std::cos(b), 0);
}

TEST(World, RollsAUnicycleAlongTheArcOfItsSpeedsWhateverTheStep) {
  for (const int physics_rate_hz : {100, 1000}) {
    Experiment e = Bodies("unicycle", {{1, 2, 0.1}});
    e.physics.rate_hz = physics_rate_hz;
    e.agents[0].heading_rad = 0.7;
    const double v = 2, w = -3;
    World world(e);
    for (int tick = 1; tick <= 1000; ++tick) {
      Fly(world, {v, w, 0, 0}, 1);
      const Motion state = world.State(1);
      const double t = e.time_s(tick);
      ASSERT_LT((state.p_WB - OnArc(e.agents[0], v, w, t)).norm(), 1e-9) << "t " << t << " at " << physics_rate_hz;
      ASSERT_GT(std::abs(state.q_WB.dot(Turned(0.7 + w * t))), 1 - 1e-9);
      ASSERT_EQ(state.p_WB.z(), 0.1);
      ASSERT_NEAR(state.w_WB_B.z(), w, 1e-12);
    }
  }
}

TEST(World, GivesAUnicycleTheVelocityOfTheChordOfTheLastStep) {
  World world(Bodies("unicycle", {{0, 0, 0.1}}));
  Fly(world, {2, -3, 0, 0}, 1);
  const double half_turn = 3 * 0.001 / 2, heading = -3 * 0.01 + half_turn;  // in the middle of the tick's last step
  const Vector3d expected = 2 * std::sin(half_turn) / half_turn * Vector3d(std::cos(heading), std::sin(heading), 0);
  EXPECT_LT((world.State(1).v_WB - expected).norm(), 1e-12);
}

TEST(World, RollsAUnicycleStraightOrTurnsItOnTheSpot) {
  Experiment e = Bodies("unicycle", {{0, 0, 0.1}});
  e.agents[0].heading_rad = std::numbers::pi / 2;
  World straight(e), turning(e);
  Fly(straight, {1.5, 0, 7, 7}, 200);
  EXPECT_LT((straight.State(1).p_WB - Vector3d(0, 3, 0.1)).norm(), 1e-12);
  Fly(turning, {0, 1, 7, 7}, 100);
  EXPECT_EQ(turning.State(1).p_WB, Vector3d(0, 0, 0.1));
  EXPECT_GT(std::abs(turning.State(1).q_WB.dot(Turned(std::numbers::pi / 2 + 1))), 1 - 1e-12);
}

TEST(World, LetsAUnicycleRollOnTheGroundWithoutTouchingIt) {
  for (const double height_m : {0.0, 0.05, 0.1}) {
    World world(Bodies("unicycle", {{0, 0, height_m}}));
    Fly(world, {1, 0.5, 0, 0}, 500);
    EXPECT_EQ(world.contacts().ground, 0);
    EXPECT_EQ(world.State(1).p_WB.z(), height_m);
  }
}

// --- rotation ---------------------------------------------------------------------------------------

/// Angular velocity (rad/s, in B) after 50 ms with only rotor `fast` (1..4) faster than at hover.
Vector3d TurnedBy(int fast) {
  World world(Bodies("quadrotor", {{0, 0, 10}}));
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  Actuation command = Rotors(hover);
  command[static_cast<std::size_t>(fast - 1)] = 1.02 * hover;
  Fly(world, command, 5);
  return world.State(1).w_WB_B;
}

TEST(World, FrontRotorLiftsTheNoseAndTurnsTheBodyLeft) {
  const Vector3d w = TurnedBy(1);
  EXPECT_NEAR(w.x(), 0, 1e-4);
  EXPECT_LT(w.y(), -1e-2);
  EXPECT_GT(w.z(), 1e-4);
}

TEST(World, LeftRotorLiftsTheLeftSideAndTurnsTheBodyRight) {
  const Vector3d w = TurnedBy(2);
  EXPECT_GT(w.x(), 1e-2);
  EXPECT_NEAR(w.y(), 0, 1e-4);
  EXPECT_LT(w.z(), -1e-4);
}

TEST(World, BackRotorDropsTheNoseAndTurnsTheBodyLeft) {
  const Vector3d w = TurnedBy(3);
  EXPECT_NEAR(w.x(), 0, 1e-4);
  EXPECT_GT(w.y(), 1e-2);
  EXPECT_GT(w.z(), 1e-4);
}

TEST(World, RightRotorDropsTheLeftSideAndTurnsTheBodyRight) {
  const Vector3d w = TurnedBy(4);
  EXPECT_LT(w.x(), -1e-2);
  EXPECT_NEAR(w.y(), 0, 1e-4);
  EXPECT_LT(w.z(), -1e-4);
}

TEST(World, TurnsWithTorqueOverInertia) {
  const Airframe body = Built("mascot");
  World world(Bodies("quadrotor", {{0, 0, 10}}));
  const double hover = body.HoverRotorSpeed(kG);
  Fly(world, {1.1 * hover, 0.9 * hover, 1.1 * hover, 0.9 * hover}, 100);
  const double torque = body.drag_n_m_s2 * hover * hover * 2 * (1.1 * 1.1 - 0.9 * 0.9);
  EXPECT_NEAR(world.State(1).w_WB_B.z(), torque / body.inertia_kg_m2.z(), 1e-9);
  const Eigen::Quaterniond q = world.State(1).q_WB;
  const double turn = torque / body.inertia_kg_m2.z();
  EXPECT_NEAR(2 * std::atan2(q.z(), q.w()), turn / 2 + 0.001 * turn / 2, 1e-9)
      << "angle after 1 s, ahead by dt (w - w(0)) / 2 (docs/frames.md, integration)";
}

TEST(World, DrivesABodyThatLeansForwardForward) {
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  World world(Bodies("quadrotor", {{0, 0, 10}}));
  Fly(world, {0.99 * hover, hover, 1.01 * hover, hover}, 20);  // nose down
  EXPECT_GT(world.State(1).v_WB.x(), 1e-3);
  EXPECT_NEAR(world.State(1).v_WB.y(), 0, 1e-6);
}

TEST(World, KeepsAngularMomentumAndEnergyOfABodyThatTumblesFreely) {
  Airframe body = WithoutDrag();
  body.inertia_kg_m2 = {0.08, 0.12, 0.18};  // three different moments of inertia, so that the body tumbles
  Experiment e = Bodies("quadrotor", {{0, 0, 1000}}, body);
  World world(e);
  Fly(world, {700, 600, 500, 400}, 30);
  const auto momentum_W = [&](const Motion& s) -> Vector3d {
    return s.q_WB * body.inertia_kg_m2.cwiseProduct(s.w_WB_B);
  };
  const auto energy_j = [&](const Motion& s) { return s.w_WB_B.dot(body.inertia_kg_m2.cwiseProduct(s.w_WB_B)) / 2; };
  Fly(world, Rotors(0), 1);
  const Motion start = world.State(1);
  ASSERT_GT(start.w_WB_B.norm(), 1.0);
  Fly(world, Rotors(0), 200);
  const Motion end = world.State(1);
  EXPECT_GT((end.w_WB_B - start.w_WB_B).norm(), 0.1 * start.w_WB_B.norm()) << "it did tumble";
  EXPECT_LT((momentum_W(end) - momentum_W(start)).norm(), 0.01 * momentum_W(start).norm());
  EXPECT_NEAR(energy_j(end), energy_j(start), 0.01 * energy_j(start));
}

TEST(World, GivesUnitQuaternionsThatNeverJump) {
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  World world(Bodies("quadrotor", {{0, 0, 10}}));
  double turned_rad = 0;
  for (int i = 0; i < 1500; ++i) {
    const Eigen::Quaterniond before = world.State(1).q_WB;
    Fly(world, {1.1 * hover, 0.9 * hover, 1.1 * hover, 0.9 * hover}, 1);
    EXPECT_NEAR(world.State(1).q_WB.norm(), 1, 1e-12);
    ASSERT_GT(before.dot(world.State(1).q_WB), 0.99);
    turned_rad += world.State(1).w_WB_B.z() * 0.01;
  }
  EXPECT_GT(turned_rad, 4 * std::numbers::pi) << "two turns: the quaternion went through its other sign";
}

// --- rotors -----------------------------------------------------------------------------------------

TEST(World, TurnsRotorsNoFasterThanTheyCanAndNotBackwards) {
  World above(Bodies("quadrotor", {{0, 0, 50}})), at_most(Bodies("quadrotor", {{0, 0, 50}}));
  Fly(above, Rotors(1e4), 20);
  Fly(at_most, Rotors(Built("mascot").MaxRotorSpeed()), 20);
  EXPECT_EQ(above.State(1).v_WB, at_most.State(1).v_WB);
  World below(Bodies("quadrotor", {{0, 0, 50}})), still(Bodies("quadrotor", {{0, 0, 50}}));
  Fly(below, Rotors(-500), 20);
  Fly(still, Rotors(0), 20);
  EXPECT_EQ(below.State(1).v_WB, still.State(1).v_WB);
}

TEST(World, LetsLaggedRotorsFollowExponentiallyFromHover) {
  Airframe body = WithoutDrag();
  body.rotor_time_constant_s = 0.1;
  World world(Bodies("quadrotor", {{0, 0, 50}}, body));
  const double hover = body.HoverRotorSpeed(kG), wanted = 1.2 * hover;
  double v = 0;
  for (int step = 1; step <= 100; ++step) {
    const double w = wanted + (hover - wanted) * std::exp(-step * 0.001 / 0.1);
    v += 0.001 * (4 * body.lift_n_s2 * w * w / body.mass_kg - kG);
  }
  Fly(world, Rotors(wanted), 10);
  EXPECT_NEAR(world.State(1).v_WB.z(), v, 1e-9);
}

TEST(World, KeepsLaggedRotorsAtHoverWhenToldToHover) {
  Airframe body = Built("crazyflie");
  World world(Bodies("quadrotor", {{0, 0, 2}}, body));
  Fly(world, Rotors(body.HoverRotorSpeed(kG)), 1000);
  EXPECT_LT((world.State(1).p_WB - Vector3d(0, 0, 2)).norm(), 1e-9);
}

/// A world with one physics step per tick and one quadrotor with rotor failures.
Experiment Failing(std::vector<RotorFailure> failures) {
  Experiment e = Bodies("quadrotor", {{0, 0, 50}}, WithoutDrag());
  e.control.rate_hz = e.physics.rate_hz;
  e.physics.rotor_failures = std::move(failures);
  return e;
}

TEST(World, TakesWhatAFailedRotorLacksFromThrustAndTorque) {
  const Airframe body = WithoutDrag();
  const double hover = body.HoverRotorSpeed(kG), dt = 0.001, lost = 0.75 * hover * hover;
  World world(Failing({{.agent = 1, .rotor = 1, .at_s = 0, .remaining = 0.25}}));
  Fly(world, Rotors(hover), 1);
  EXPECT_NEAR(world.State(1).v_WB.z(), -dt * body.lift_n_s2 * lost / body.mass_kg, 1e-12) << "it loses height";
  const Vector3d torque(0, body.lift_n_s2 * body.arm_m * lost, -body.drag_n_m_s2 * lost);
  EXPECT_LT((world.State(1).w_WB_B - dt * torque.cwiseQuotient(body.inertia_kg_m2)).norm(), 1e-9) << "nose down, right";
}

TEST(World, DropsTheSideWhoseRotorFails) {
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  const std::array<Vector3d, 4> turns = {{{0, 1, -1}, {-1, 0, 1}, {0, -1, -1}, {1, 0, 1}}};  // signs of w_WB_B
  for (int rotor = 1; rotor <= 4; ++rotor) {
    World world(Failing({{.agent = 1, .rotor = rotor, .at_s = 0}}));
    Fly(world, Rotors(hover), 20);
    const Vector3d w = world.State(1).w_WB_B;
    const Vector3d& turn = turns[static_cast<std::size_t>(rotor - 1)];
    for (int axis = 0; axis < 3; ++axis) {
      if (turn[axis] == 0)
        EXPECT_NEAR(w[axis], 0, 1e-3) << "rotor " << rotor;
      else
        EXPECT_GT(turn[axis] * w[axis], 1e-3) << "rotor " << rotor << " axis " << axis;
    }
  }
}

TEST(World, LetsARotorFailInTheStepThatBeginsAtItsTime) {
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  World world(Failing({{.agent = 1, .rotor = 2, .at_s = 0.3}}));
  Fly(world, Rotors(hover), 300);
  EXPECT_LT(world.State(1).v_WB.norm() + world.State(1).w_WB_B.norm(), 1e-12) << "0.3 s: until now it hovers";
  Fly(world, Rotors(hover), 1);
  EXPECT_LT(world.State(1).v_WB.z(), -1e-3);
}

TEST(World, LetsTheLatestFailureOfARotorCountWhateverTheirOrder) {
  const double hover = Built("mascot").HoverRotorSpeed(kG);
  World world(Failing({{.agent = 1, .rotor = 3, .at_s = 0.002, .remaining = 0},
                       {.agent = 1, .rotor = 3, .at_s = 0.001, .remaining = 0.5},
                       {.agent = 1, .rotor = 3, .at_s = 0.003, .remaining = 1}}));
  const std::array<double, 4> lost_parts = {0, 0.5, 1, 0};  // lost fraction of a quarter of the thrust
  for (const double lost : lost_parts) {
    const double v_before = world.State(1).v_WB.z();
    Fly(world, Rotors(hover), 1);
    EXPECT_NEAR(world.State(1).v_WB.z() - v_before, -lost * kG / 4 * 0.001, 1e-7);
  }
}

TEST(World, LetsOnlyTheRotorsOfTheAgentNamedFail) {
  Experiment e = Bodies("quadrotor", {{0, 0, 50}, {9, 0, 50}});
  e.physics.rotor_failures = {{.agent = 2, .rotor = 1, .at_s = 0}};
  World world(e);
  const Actuation hover = Rotors(Built("mascot").HoverRotorSpeed(kG));
  for (int i = 0; i < 100; ++i) world.Step(std::array<Actuation, 2>{hover, hover});
  EXPECT_LT((world.State(1).p_WB - e.agents[0].p_W).norm(), 1e-9);
  EXPECT_LT(world.State(2).p_WB.z(), 49.5);
}

// --- wind -------------------------------------------------------------------------------------------

TEST(World, BlowsAQuadrotorAwayAsDragSays) {
  const Airframe body = Built("mascot");
  const double kept = 1 - 0.001 * body.linear_drag_kg_per_s / body.mass_kg;  // fraction of airspeed left per step
  ASSERT_LT(kept, 1);
  Experiment e = Bodies("quadrotor", {{0, 0, 50}});
  e.physics.wind.mean_m_per_s = {4, -2, 0.5};
  World world(e);
  const auto v_after = [&](int steps) -> Vector3d { return (1 - std::pow(kept, steps)) * e.physics.wind.mean_m_per_s; };
  Fly(world, Rotors(body.HoverRotorSpeed(kG)), 1);
  EXPECT_LT((world.State(1).v_WB - v_after(10)).norm(), 1e-12) << "first B wind / m";
  Fly(world, Rotors(body.HoverRotorSpeed(kG)), 999);
  EXPECT_LT((world.State(1).v_WB - v_after(10000)).norm(), 1e-9);
}

TEST(World, DriftsWithTheWindInTheEnd) {
  Airframe body = Built("mascot");
  body.linear_drag_kg_per_s = 2;
  Experiment e = Bodies("quadrotor", {{0, 0, 50}}, body);
  e.physics.wind.mean_m_per_s = {4, -2, 0.5};
  World world(e);
  Fly(world, Rotors(body.HoverRotorSpeed(kG)), 3000);
  EXPECT_LT((world.State(1).v_WB - e.physics.wind.mean_m_per_s).norm(), 1e-6);
}

TEST(World, BlowsOnAllQuadrotorsAlikeAndOnNothingElse) {
  Experiment e = Bodies("quadrotor", {{0, 0, 50}, {10, 0, 50}, {20, 0, 50}, {30, 0, 50}, {40, 0, 50}});
  e.agents[2].model = "double_integrator";
  e.agents[3].model = "single_integrator";
  e.agents[4].model = "unicycle";
  e.physics.wind = {.mean_m_per_s = {3, 0, 0}, .gust_std_m_per_s = 2, .gust_time_s = 0.5};
  World world(e);
  const Actuation hover = Rotors(Built("mascot").HoverRotorSpeed(kG));
  for (int i = 0; i < 200; ++i) world.Step(std::array<Actuation, 5>{hover, hover, Rotors(0), Rotors(0), Rotors(0)});
  EXPECT_GT(world.State(1).v_WB.norm(), 0.1);
  EXPECT_EQ(world.State(1).v_WB, world.State(2).v_WB);
  for (const int id : {3, 4, 5}) EXPECT_EQ(world.State(id).p_WB, e.agent(id).p_W) << e.agent(id).model;
}

TEST(World, HasTheGustsOfItsSeed) {
  const auto blown = [](std::uint64_t seed, double gust_std_m_per_s, double gust_time_s) {
    Experiment e = Bodies("quadrotor", {{0, 0, 50}});
    e.run.seed = seed;
    e.physics.wind = {.gust_std_m_per_s = gust_std_m_per_s, .gust_time_s = gust_time_s};
    World world(e);
    Fly(world, Rotors(Built("mascot").HoverRotorSpeed(kG)), 100);
    return world.State(1).v_WB;
  };
  EXPECT_EQ(blown(1, 2, 1), blown(1, 2, 1));
  EXPECT_NE(blown(1, 2, 1), blown(2, 2, 1));
  EXPECT_NE(blown(1, 2, 1), blown(1, 2, 2));
  EXPECT_LT(blown(1, 0, 1).norm(), 1e-10);
}

// --- contacts ---------------------------------------------------------------------------------------

/// Two double integrators at a distance of 2 m that fly towards each other with 1 m/s each.
Experiment HeadOn() {
  Experiment e = Bodies("double_integrator", {{-1, 0, 1}, {1, 0, 1}});
  e.agents[0].v_W = {1, 0, 0};
  e.agents[1].v_W = {-1, 0, 0};
  return e;
}

void Drift(World& world, int bodies, int ticks) {
  const std::vector<Actuation> still(static_cast<std::size_t>(bodies), Rotors(0));
  for (int i = 0; i < ticks; ++i) world.Step(still);
}

TEST(World, ExchangesMomentumInACollisionAndLosesNone) {
  Experiment e = HeadOn();
  e.agents[0].v_W.x() = 2;
  World world(e);
  Drift(world, 2, 200);
  EXPECT_EQ(world.collisions(), 1);
  EXPECT_NEAR(world.State(1).v_WB.x() + world.State(2).v_WB.x(), 1.0, 1e-9);
  EXPECT_LE(world.State(1).v_WB.x(), world.State(2).v_WB.x() + 1e-9) << "they no longer approach";
  EXPECT_GT(world.State(2).p_WB.x() - world.State(1).p_WB.x(), 0.199) << "spheres of 0.1 m stay outside each other";
}

TEST(World, LetsBodiesPassThroughEachOtherWithoutCollisions) {
  Experiment e = HeadOn();
  e.physics.collisions = false;
  World world(e);
  Drift(world, 2, 200);
  EXPECT_EQ(world.collisions(), 0);
  EXPECT_NEAR(world.State(1).p_WB.x(), 1, 1e-9);
  EXPECT_NEAR(world.State(2).p_WB.x(), -1, 1e-9);
}

TEST(World, CountsACollisionEachTimeBodiesMeet) {
  World world(HeadOn());
  Drift(world, 2, 110);
  EXPECT_EQ(world.collisions(), 1);
  ASSERT_EQ(world.contacts().first.size(), 1u);
  const Contact& contact = world.contacts().first[0];
  EXPECT_EQ(contact.agent, 1);
  EXPECT_EQ(contact.other, 2);
  EXPECT_NEAR(static_cast<double>(contact.tick), 90, 1) << "2 m apart but for two radii of 0.1 m, at 2 m/s and 100 Hz";
  EXPECT_NEAR(contact.speed_m_per_s, 2, 1e-9);
  for (int i = 0; i < 50; ++i) world.Step(std::array<Actuation, 2>{{{-1, 0, 0, 0}, {1, 0, 0, 0}}});   // apart
  for (int i = 0; i < 200; ++i) world.Step(std::array<Actuation, 2>{{{1, 0, 0, 0}, {-1, 0, 0, 0}}});  // and back
  EXPECT_EQ(world.collisions(), 2);
  for (int i = 0; i < 300; ++i)
    world.Step(std::array<Actuation, 2>{{{1, 0, 0, 0}, {-1, 0, 0, 0}}});  // pressed together
  EXPECT_EQ(world.collisions(), 2);
}

TEST(World, CountsBodiesThatSlideAlongEachOtherOnce) {
  for (const std::string_view model : {"double_integrator", "single_integrator", "unicycle"}) {
    Experiment e = Bodies(model, {{-1, 0, 1}, {1, 0.05, 1}});
    e.agents[1].heading_rad = std::numbers::pi;
    World world(e);
    const double forward = model == "unicycle" ? 1 : -1;
    for (int i = 0; i < 500; ++i) world.Step(std::array<Actuation, 2>{{{1, 0, 0, 0}, {forward, 0, 0, 0}}});
    EXPECT_EQ(world.contacts().agents, 1) << model;
  }
}

TEST(World, LandsABodyOnTheGroundWhereItRests) {
  for (const bool collisions : {true, false}) {
    Experiment e = Bodies("quadrotor", {{0, 0, 1}});
    e.physics.collisions = collisions;
    World world(e);
    Fly(world, Rotors(0), 500);
    const Motion rest = world.State(1);
    EXPECT_NEAR(rest.p_WB.z(), Built("mascot").size_m.z() / 2, 1e-3);
    EXPECT_LT(rest.v_WB.norm(), 1e-6);
    EXPECT_LT(rest.w_WB_B.norm(), 1e-6);
    EXPECT_EQ(world.collisions(), 1) << "resting is one contact";
    Fly(world, Rotors(1.1 * Built("mascot").HoverRotorSpeed(kG)), 100);
    EXPECT_GT(world.State(1).p_WB.z(), 0.5) << "and it takes off again";
  }
}

// The smallest moments of inertia that ReadAirframe() takes for mass and size; dropped with a tumble.
TEST(World, RestsOnTheGroundWithTheSmallestMomentsOfInertiaThatAnAirframeMayHave) {
  for (Airframe airframe : Airframes()) {
    const Vector3d squares = airframe.size_m.cwiseAbs2();
    airframe.inertia_kg_m2 = 0.05 * airframe.mass_kg / 12 * (Vector3d::Constant(squares.sum()) - squares);
    World world(Bodies("quadrotor", {{0, 0, 2}}, airframe));
    const double hover = airframe.HoverRotorSpeed(kG);
    Fly(world, {hover, 0.99 * hover, 0.98 * hover, hover}, 20);
    double deepest_m = 0;
    for (int tick = 0; tick < 1500; ++tick) {
      Fly(world, Rotors(0), 1);
      const Motion now = world.State(1);
      const double below_m =
          now.q_WB.toRotationMatrix().row(2).cwiseAbs().transpose().dot(airframe.size_m / 2) - now.p_WB.z();
      deepest_m = std::max(deepest_m, below_m);
    }
    EXPECT_LT(deepest_m, airframe.size_m.minCoeff()) << airframe.name;
    const Motion rest = world.State(1);
    EXPECT_NEAR(rest.p_WB.z(), rest.q_WB.toRotationMatrix().row(2).cwiseAbs().transpose().dot(airframe.size_m / 2),
                2e-3)
        << airframe.name;
    EXPECT_LT(rest.v_WB.norm(), 0.01) << airframe.name;
  }
}

TEST(World, HasNoGroundIfItIsOff) {
  Experiment e = Bodies("quadrotor", {{0, 0, 1}});
  e.physics.ground = false;
  World world(e);
  Fly(world, Rotors(0), 200);
  EXPECT_LT(world.State(1).p_WB.z(), -10);
  EXPECT_EQ(world.collisions(), 0);
}

// --- obstacles --------------------------------------------------------------------------------------

/// A double integrator at `from` with initial velocity `v_W`, and one obstacle.
Experiment Towards(const Obstacle& obstacle, const Vector3d& from, const Vector3d& v_W) {
  Experiment e = Bodies("double_integrator", {from});
  e.agents[0].v_W = v_W;
  e.physics.obstacles = {obstacle};
  return e;
}

TEST(World, StopsABodyAtTheSurfaceOfAnObstacle) {
  constexpr double kYaw = std::numbers::pi / 4;
  constexpr double kRounded_m = 0.04;  // Bullet rounds edges by this margin, which moves the edge of the box inwards
  const double edge = -std::sqrt(2) * (1 - kRounded_m) - kRounded_m - 0.1;
  const Vector3d from(-3, 0, 5), east(1, 0, 0), above(0, 0, 8), down(0, 0, -1), at(0, 0, 5);
  const std::array cases = {
      std::tuple(Obstacle{Shape::kBox, at, {2, 8, 4}, 0}, from, east, Vector3d(-1.1, 0, 5)),
      std::tuple(Obstacle{Shape::kBox, at, {2, 8, 4}, 2 * kYaw}, Vector3d(-9, 0, 5), east, Vector3d(-4.1, 0, 5)),
      std::tuple(Obstacle{Shape::kBox, at, {2, 8, 4}, 0}, above, down, Vector3d(0, 0, 7.1)),
      std::tuple(Obstacle{Shape::kBox, at, {2, 2, 4}, kYaw}, from, east, Vector3d(edge, 0, 5)),
      std::tuple(Obstacle{Shape::kSphere, at, {3, 3, 3}, 0}, from, east, Vector3d(-1.6, 0, 5)),
      std::tuple(Obstacle{Shape::kSphere, at, {3, 3, 3}, 0}, above, down, Vector3d(0, 0, 6.6)),
      std::tuple(Obstacle{Shape::kCylinder, at, {2, 2, 4}, 0}, from, east, Vector3d(-1.1, 0, 5)),
      std::tuple(Obstacle{Shape::kCylinder, at, {2, 2, 4}, 0}, above, down, Vector3d(0, 0, 7.1)),
  };
  for (const auto& [obstacle, start, v_W, end] : cases) {
    World world(Towards(obstacle, start, v_W));
    Drift(world, 1, 1000);
    EXPECT_LT((world.State(1).p_WB - end).norm(), 3e-3) << end.transpose() << "\n" << world.State(1).p_WB.transpose();
    EXPECT_EQ(world.contacts().obstacles, 1);
    EXPECT_EQ(world.collisions(), 1);
  }
}

TEST(World, HoldsABodyDrivenByVelocityOutsideAnObstacle) {
  Experiment e = Bodies("single_integrator", {{-3, 0, 1}, {-3, 9, 1}});
  e.agents[1].model = "unicycle";
  e.physics.obstacles = {{Shape::kBox, {0, 0, 1}, {2, 30, 2}, 0}};
  World world(e);
  for (int i = 0; i < 1000; ++i) world.Step(std::array<Actuation, 2>{{{1, 0, 0, 0}, {1, 0, 0, 0}}});
  for (const int id : {1, 2}) {
    EXPECT_NEAR(world.State(id).p_WB.x(), -1.1, 2e-3);
    EXPECT_NEAR(world.State(id).v_WB.x(), 0, 1e-9);
  }
  EXPECT_EQ(world.contacts().obstacles, 2);
}

TEST(World, LetsBodiesPassThroughObstaclesWithoutCollisions) {
  Experiment e = Towards({Shape::kBox, {0, 0, 5}, {2, 2, 2}, 0}, {-3, 0, 5}, {1, 0, 0});
  e.physics.collisions = false;
  World world(e);
  Drift(world, 1, 600);
  EXPECT_NEAR(world.State(1).p_WB.x(), 3, 1e-9);
  EXPECT_EQ(world.contacts().obstacles, 0);
}

TEST(World, KeepsAUnicycleUprightAtItsHeightWhateverHitsIt) {
  Experiment e = Bodies("unicycle", {{0, 0, 0.1}, {-1, 0.05, 0.2}});
  e.agents[1].model = "double_integrator";
  e.agents[1].v_W = {2, 0, 0};
  World world(e);
  for (int i = 0; i < 200; ++i) {
    world.Step(std::array<Actuation, 2>{{{0, 0, 0, 0}, {1, 0, 0, 0}}});
    ASSERT_EQ(world.State(1).p_WB.z(), 0.1);
    ASSERT_NEAR((world.State(1).q_WB * Vector3d::UnitZ()).z(), 1, 1e-12);
  }
  EXPECT_GE(world.contacts().agents, 1);
}

TEST(World, CountsContactsByWhatWasTouched) {
  Experiment e = Bodies("double_integrator", {{-1, 0, 5}, {1, 0, 5}, {0, 9, 0.5}, {9, 9, 5}, {20, 0, 5}});
  e.agents[0].v_W = {1, 0, 0};   // hits agent 2
  e.agents[2].v_W = {0, 0, -1};  // hits the ground
  e.agents[3].v_W = {1, 0, 0};   // hits the second obstacle
  e.physics.obstacles = {{Shape::kSphere, {50, 50, 5}, {1, 1, 1}, 0}, {Shape::kBox, {11, 9, 5}, {1, 1, 1}, 0}};
  World world(e);
  Drift(world, 5, 300);
  EXPECT_EQ(world.contacts().agents, 1);
  EXPECT_EQ(world.contacts().ground, 1);
  EXPECT_EQ(world.contacts().obstacles, 1);
  EXPECT_EQ(world.collisions(), 3);
}

// --- determinism ------------------------------------------------------------------------------------

TEST(World, RepeatsARunToTheBit) {
  std::vector<Vector3d> places;
  for (int i = 0; i < 8; ++i) {  // a heap: many contacts
    const int row = i / 3, column = i % 3;
    places.push_back({0.3 * column, 0.3 * row, 0.2 + 0.1 * i});
  }
  const auto run = [&] {
    Experiment e = Bodies("quadrotor", places);
    e.agents[3].model = e.agents[5].model = "double_integrator";
    World world(e);
    std::mt19937_64 random(5);
    std::vector<double> bits;
    for (int tick = 0; tick < 200; ++tick) {
      std::vector<Actuation> commands(places.size());
      for (Actuation& command : commands)
        for (double& value : command) value = static_cast<double>(random() >> 11) * 0x1p-53 * 10;
      world.Step(commands);
      for (int id = 1; id <= e.size(); ++id) {
        const Motion s = world.State(id);
        bits.insert(bits.end(), s.p_WB.begin(), s.p_WB.end());
        bits.insert(bits.end(), s.v_WB.begin(), s.v_WB.end());
        bits.insert(bits.end(), s.q_WB.coeffs().begin(), s.q_WB.coeffs().end());
        bits.insert(bits.end(), s.w_WB_B.begin(), s.w_WB_B.end());
      }
    }
    EXPECT_GT(world.collisions(), 8);
    return bits;
  };
  const std::vector<double> once = run();
  const World moves_the_heap(Bodies("quadrotor", {{0, 0, 1}, {9, 0, 1}}));
  const std::vector<double> again = run();
  ASSERT_EQ(once.size(), again.size());
  EXPECT_EQ(std::memcmp(once.data(), again.data(), once.size() * sizeof(double)), 0);
}

// --- refusals ---------------------------------------------------------------------------------------

TEST(World, RefusesACommandThatIsNotFinite) {
  World world(Bodies("double_integrator", {{0, 0, 1}, {5, 0, 1}, {10, 0, 1}}));
  Drift(world, 3, 12);
  std::vector<Actuation> commands(3, Rotors(0));
  commands[2][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { world.Step(commands); }, ThrowsMessage<std::runtime_error>("tick 12: agent 3: actuator[1] is nan"));
  commands[2][1] = -std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { world.Step(commands); },
              ThrowsMessage<std::runtime_error>("tick 12: agent 3: actuator[1] is -inf"));
  commands[0][3] = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { world.Step(commands); }, ThrowsMessage<std::runtime_error>("tick 12: agent 1: actuator[3] is inf"));
  EXPECT_EQ(world.tick(), 12) << "nothing moved";
}

TEST(World, RefusesAStateThatIsNotFinite) {
  World world(Bodies("double_integrator", {{0, 0, 1}, {5, 0, 1}}));
  const std::array<Actuation, 2> commands = {{{0, 0, 0, 0}, {1e308, 0, 0, 0}}};
  EXPECT_THAT(
      [&] {
        for (int i = 0; i < 1000; ++i) world.Step(commands);
      },
      ThrowsMessage<std::runtime_error>(::testing::MatchesRegex("tick [0-9]+: agent 2: its state is not finite")));
}

TEST(World, RequiresOneCommandPerAgent) {
  World world(Bodies("double_integrator", {{0, 0, 1}, {5, 0, 1}}));
  EXPECT_THAT([&] { world.Step(std::array<Actuation, 1>{Rotors(0)}); },
              ThrowsMessage<std::invalid_argument>("World::Step: one command per agent"));
}

}  // namespace
}  // namespace mascot
