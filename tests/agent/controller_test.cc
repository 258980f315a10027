#include "agent/controller.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>

#include "agent/controllers/quadrotor.h"
#include "agent/low_level.h"
#include "physics_server/model.h"
#include "physics_server/world.h"
#include "tests/physics_server/one_body.h"

namespace mascot {
namespace {

using Eigen::Vector3d;
using ::testing::ThrowsMessage;

constexpr double kG = 9.81;

/// One quadrotor at (1, 2, 3), for tests of its first command.
Experiment One(const Airframe& airframe = Built("mascot")) { return Bodies("quadrotor", {{1, 2, 3}}, airframe); }

Motion AtStart(const Experiment& e) {
  Motion motion;
  motion.p_WB = e.agents[0].p_W;
  motion.v_WB = e.agents[0].v_W;
  return motion;
}

Controller::Output First(const Experiment& e, const Motion& self, const Vector3d& a_W = Vector3d::Zero()) {
  return ControllerOfOne(e, 1).Actuate(self, a_W);
}

/// Thrust (N) and torques (N m) of a command.
Eigen::Vector4d WrenchOf(const Experiment& e, const Controller::Output& output) {
  return e.agents[0].airframe.Allocation() * Eigen::Vector4d::Map(output.actuator.data()).cwiseAbs2();
}

/// An airframe with gains so low that no first command reaches a rotor limit: torques are then exactly the PD terms.
Airframe Soft() {
  Airframe body = WithoutDrag();
  body.attitude = {10, 5};
  return body;
}

/// Roll and pitch target (rad) of the first command, computed from its torques, for a level body at rest with Soft()
/// gains.
Eigen::Vector2d Target(const Experiment& e, const Vector3d& a_W) {
  const Airframe& body = e.agents[0].airframe;
  const Eigen::Vector4d wrench = WrenchOf(e, First(e, AtStart(e), a_W));
  return wrench.segment<2>(1).cwiseQuotient(body.inertia_kg_m2.head<2>()) / body.attitude.kp;
}

Motion Tilted(const Experiment& e, double roll, double pitch, double yaw) {
  Motion self = AtStart(e);
  self.q_WB = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
              Eigen::AngleAxisd(roll, Vector3d::UnitX());
  return self;
}

// --- the table --------------------------------------------------------------------------------------

TEST(MakeController, HasOneForEveryModel) {
  for (const ModelTraits& model : Models())
    EXPECT_NO_THROW(ControllerOfOne(Bodies(model.name, {{0, 0, 1}}), 1)) << model.name;
}

TEST(MakeController, NamesTheModelItHasNoneFor) {
  EXPECT_THAT(
      [] {
        ControllerOfOne(Bodies("submarine", {{0, 0, 1}}), 1);
      },
      ThrowsMessage<std::invalid_argument>("no controller for the model: submarine"));
}

// --- double integrator ------------------------------------------------------------------------------

TEST(DoubleIntegratorController, TurnsAccelerationIntoForceAndHoldsItsHeight) {
  Experiment e = Bodies("double_integrator", {{0, 0, 2}});
  Motion self = AtStart(e);
  EXPECT_EQ(First(e, self, {1, -2, 3}).actuator, (Actuation{1, -2, 0, 0}));
  self.p_WB.z() = 1.5;
  self.v_WB.z() = 0.1;
  const PdGains gains = e.agents[0].airframe.altitude;
  EXPECT_NEAR(First(e, self, {0, 0, 0}).actuator[2], gains.kp * 0.5 - gains.kd * 0.1, 1e-12);
  e.agents[0].law.axes = Axes::kXyz;
  EXPECT_EQ(First(e, self, {1, -2, 3}).actuator, (Actuation{1, -2, 3, 0}));
}

// --- quadrotor: the first command -------------------------------------------------------------------

TEST(QuadrotorController, HoversWithHoverRotorSpeeds) {
  for (const Airframe& airframe : Airframes())
    for (const Inversion inversion : {Inversion::kSmallAngle, Inversion::kExact}) {
      Experiment e = One(airframe);
      e.agents[0].control.inversion = inversion;
      const Controller::Output output = First(e, AtStart(e));
      for (const double speed : output.actuator) EXPECT_NEAR(speed, airframe.HoverRotorSpeed(kG), 1e-9);
      EXPECT_EQ(output.flags, 0u);
    }
}

TEST(QuadrotorController, DropsItsNoseToGoForwardAndItsLeftSideToGoLeft) {
  const Experiment e = One(Soft());
  EXPECT_GT(Target(e, {0.1, 0, 0})[1], 0) << "pitch: nose down";
  EXPECT_LT(Target(e, {0, 0.1, 0})[0], 0) << "roll: left side down";
}

TEST(QuadrotorController, GoesEastWhicheverWayItLooks) {
  const Experiment e = One(Soft());
  const Motion looks_north = Tilted(e, 0, 0, std::numbers::pi / 2);
  Experiment north = e;
  north.agents[0].control.heading_rad = std::numbers::pi / 2;
  const Eigen::Vector4d wrench = WrenchOf(e, First(north, looks_north, {0.1, 0, 0}));
  EXPECT_GT(wrench[1], 1e-3) << "east is to its right: it rolls right";
  EXPECT_NEAR(wrench[2], 0, 1e-9);
  EXPECT_NEAR(wrench[3], 0, 1e-9) << "it looks where it should";
}

TEST(QuadrotorController, InvertsForSmallAnglesAsThePaperDoes) {
  const Eigen::Vector2d target = Target(One(Soft()), {1.5, -0.8, 0});
  EXPECT_NEAR(target[0], 0.8 / kG, 1e-12);
  EXPECT_NEAR(target[1], 1.5 / kG, 1e-12);
}

TEST(QuadrotorController, InvertsExactlyWhenAsked) {
  Experiment e = One(Soft());
  e.agents[0].control.inversion = Inversion::kExact;
  const Vector3d a_W(1.5, -0.8, 0);
  const Eigen::Vector2d target = Target(e, a_W);
  const Vector3d z_B = Tilted(e, target[0], target[1], 0).q_WB * Vector3d::UnitZ();
  EXPECT_LT((z_B - (a_W + Vector3d(0, 0, kG)).normalized()).norm(), 1e-12) << "thrust points along a + g";
}

TEST(QuadrotorController, ExactInversionCarriesTheWeightOfATiltedBodyAndThePapersDoesNot) {
  Experiment e = One();
  const Motion tilted = Tilted(e, 0.2, -0.3, 0);
  const double weight_n = e.agents[0].airframe.mass_kg * kG;
  EXPECT_NEAR(WrenchOf(e, First(e, tilted))[0], weight_n, 1e-9);
  e.agents[0].control.inversion = Inversion::kExact;
  EXPECT_NEAR(WrenchOf(e, First(e, tilted))[0], weight_n / (std::cos(0.2) * std::cos(0.3)), 1e-9);
}

TEST(QuadrotorController, HoldsItsInitialHeightAndIgnoresTheLawInZ) {
  const Experiment e = One();
  Motion self = AtStart(e);
  self.p_WB.z() -= 0.1;
  self.v_WB.z() = 0.05;
  const Airframe& body = e.agents[0].airframe;
  const double thrust_n = body.mass_kg * (body.altitude.kp * 0.1 - body.altitude.kd * 0.05 + kG);
  EXPECT_NEAR(WrenchOf(e, First(e, self, {0, 0, 2}))[0], thrust_n + body.linear_drag_kg_per_s * 0.05, 1e-9);
}

TEST(QuadrotorController, TakesTheLawsVerticalAccelerationWhenItSteersXyz) {
  Experiment e = One();
  e.agents[0].law.axes = Axes::kXyz;
  EXPECT_NEAR(WrenchOf(e, First(e, AtStart(e), {0, 0, 2}))[0], e.agents[0].airframe.mass_kg * (kG + 2), 1e-9);
}

TEST(QuadrotorController, WithoutGravityItsLeastThrustAcceleratesIt) {
  for (const Inversion inversion : {Inversion::kSmallAngle, Inversion::kExact}) {
    Experiment e = One(Soft());
    e.physics.gravity_m_per_s2 = 0;
    e.agents[0].control.inversion = inversion;
    const Airframe& body = e.agents[0].airframe;
    const Eigen::Vector4d idle = WrenchOf(e, First(e, AtStart(e)));
    EXPECT_NEAR(idle[0], body.MinCommandedThrust(), 1e-9);
    EXPECT_NEAR(idle.tail<3>().norm(), 0, 1e-12) << "stays level";
    const double up = body.MinCommandedThrust() / body.mass_kg;
    const double pitch_rad = inversion == Inversion::kExact ? std::atan(0.4 / up) : 0.4 / up;
    EXPECT_NEAR(Target(e, {0.4, 0, 0})[1], pitch_rad, 1e-12);
  }
}

TEST(QuadrotorController, TurnsToItsHeadingTheShortWay) {
  Experiment e = One(Soft());
  e.agents[0].airframe.heading = {0.1, 0};  // small enough for the rotors' small yaw torque
  e.agents[0].control.heading_rad = 3.0;
  const double left_rad = 2 * std::numbers::pi - 6.0;  // from -3 to 3 rad, turning right
  const double tau_z = WrenchOf(e, First(e, Tilted(e, 0, 0, -3.0)))[3];
  EXPECT_NEAR(tau_z, -0.1 * left_rad * e.agents[0].airframe.inertia_kg_m2.z(), 1e-9);
}

TEST(QuadrotorController, BrakesTurningOfItsBody) {
  const Experiment e = One(Soft());
  Motion self = AtStart(e);
  self.w_WB_B = {0.1, -0.2, 0.01};
  const Airframe& body = e.agents[0].airframe;
  const Vector3d rates(body.attitude.kd * 0.1, body.attitude.kd * -0.2, body.heading.kd * 0.01);
  EXPECT_LT((WrenchOf(e, First(e, self)).tail<3>() + body.inertia_kg_m2.cwiseProduct(rates)).norm(), 1e-9);
}

TEST(QuadrotorController, AddsTheDragItKnowsOfUnlessToldNotTo) {
  Airframe body = Soft();
  body.linear_drag_kg_per_s = 0.3;
  Experiment e = One(body);
  e.agents[0].v_W = {2, 0, 0};
  EXPECT_NEAR(Target(e, {0, 0, 0})[1], 0.3 * 2 / body.mass_kg / kG, 1e-12);
  e.agents[0].control.drag_compensation = false;
  EXPECT_NEAR(Target(e, {0, 0, 0})[1], 0, 1e-12);
}

TEST(QuadrotorController, TiltsNoFurtherThanTheAirframesLimitAndSaysSo) {
  Airframe body = Soft();
  body.tilt_limit_rad = 0.1;
  const Experiment e = One(body);
  const Eigen::Vector2d target = Target(e, {0.5, 3, 0});
  EXPECT_NEAR(target[0], -0.1, 1e-12);
  EXPECT_NEAR(target[1], 0.5 / kG, 1e-12) << "the other axis keeps its own";
  EXPECT_EQ(First(e, AtStart(e), {0.5, 3, 0}).flags, kTiltLimited);
  EXPECT_EQ(First(e, AtStart(e), {0.5, 0.5, 0}).flags, 0u);
}

TEST(QuadrotorController, SaysThatItsRotorsAreLimited) {
  const Experiment e = One();
  Motion self = AtStart(e);
  self.p_WB.z() -= 100;
  const Controller::Output output = First(e, self);
  EXPECT_EQ(output.flags, kRotorLimited);
  for (const double speed : output.actuator) EXPECT_LE(speed, e.agents[0].airframe.MaxRotorSpeed());
}

// --- quadrotor: the reference -----------------------------------------------------------------------

TEST(QuadrotorController, CatchesUpWithTheIdealDoubleIntegratorOfItsLaw) {
  Airframe body = Soft();
  body.position = {0.5, 0.25};
  const Experiment e = One(body);
  ControllerOfOne controller(e, 1);
  controller.Actuate(AtStart(e), {2, 0, 0});  // the reference is now ahead of the body, which has not moved
  const double h = e.period_s();
  const Eigen::Vector4d wrench = WrenchOf(e, controller.Actuate(AtStart(e), {0, 0, 0}));
  const double correction = 0.5 * (h * h / 2 * 2) + 0.25 * (h * 2);
  EXPECT_NEAR(wrench[2], body.inertia_kg_m2.y() * body.attitude.kp * correction / kG, 1e-9);
}

TEST(QuadrotorController, ForgetsAReferenceThatTheBodyWasHeldBackFrom) {
  const Experiment e = One();
  ControllerOfOne controller(e, 1);
  for (int tick = 0; tick < 1000; ++tick) controller.Actuate(AtStart(e), {1, 0, 0});  // held for 10 s
  const Airframe& body = e.agents[0].airframe;
  const double pitch_torque = WrenchOf(e, controller.Actuate(AtStart(e), {-1, 0, 0}))[2];
  EXPECT_LT(pitch_torque, 0.0) << "it follows its law at once";
  Experiment soft = One(Soft());
  ControllerOfOne pushed(soft, 1);
  Motion away = AtStart(soft);
  away.p_WB.x() += 5;
  const Eigen::Vector4d wrench = WrenchOf(soft, pushed.Actuate(away, {0, 0, 0}));
  EXPECT_NEAR(wrench[2], 0, 1e-9) << "where to go after a push is the law's business";
  EXPECT_NEAR(wrench[0], body.mass_kg * kG, 1e-9);
}

TEST(QuadrotorController, TurnsNoFasterThanItCanBrake) {
  Airframe body = WithoutDrag();
  body.inertia_kg_m2 /= 10;  // rotors that can give any torque
  Experiment e = One(body);
  const Vector3d leap(3, 0, 0);
  const double turn = WrenchOf(e, First(e, AtStart(e), leap))[2] / body.inertia_kg_m2.y();
  EXPECT_LT(turn, body.attitude.kp * 3 / kG) << "less than the PD law would ask for";
  Motion turning = AtStart(e);
  turning.w_WB_B.y() = 3.0;
  EXPECT_NEAR(WrenchOf(e, First(e, turning, leap))[2], 0, 1e-9) << "3 rad/s is enough";
}

// --- docs/frames.md, "The body" ---------------------------------------------------------------------

/// Thrust (N) and torques (N m) for a first command `u_W`, computed as docs/frames.md says, without limits of the
/// rotors.
Eigen::Vector4d AsDocumented(const Experiment& e, const Motion& self, const Vector3d& u_W, double roll, double pitch,
                             double yaw) {
  const AgentConfig& agent = e.agents[0];
  const Airframe& body = agent.airframe;
  Vector3d a_W = u_W + body.linear_drag_kg_per_s * self.v_WB / body.mass_kg;
  for (int axis = 0; axis < 3; ++axis) {
    const PdGains& gains = axis < 2 ? body.position : body.altitude;
    const double correction =
        gains.kp * (agent.p_W[axis] - self.p_WB[axis]) + gains.kd * (agent.v_W[axis] - self.v_WB[axis]);
    if (std::abs(correction) <= 1) a_W[axis] += correction;
  }
  const double forward = std::cos(yaw) * a_W.x() + std::sin(yaw) * a_W.y();
  const double left = std::cos(yaw) * a_W.y() - std::sin(yaw) * a_W.x();
  const auto tilt_torque = [&](double j, double wanted, double angle, double rate) {
    const double target = std::clamp(wanted, -body.tilt_limit_rad, body.tilt_limit_rad);
    const double most = 3 * body.attitude.kd;
    return j * (std::clamp(body.attitude.kp * (target - angle), -most, most) - body.attitude.kd * rate);
  };
  const Vector3d& j = body.inertia_kg_m2;
  const Vector3d& w = self.w_WB_B;
  return {body.mass_kg * (a_W.z() + kG), tilt_torque(j.x(), -left / kG, roll, w.x()),
          tilt_torque(j.y(), forward / kG, pitch, w.y()),
          j.z() * (body.heading.kp * (agent.control.heading_rad - yaw) - body.heading.kd * w.z())};
}

TEST(FramesDoc, SaysWhatTheLowLevelStackDoes) {
  std::mt19937_64 random(1);
  const auto within = [&](double most) { return most * (2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1); };
  const auto vector = [&](double most) { return Vector3d(within(most), within(most), within(most)); };
  int free = 0, kept = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Experiment e = One();
    e.agents[0].law.axes = Axes::kXyz;
    e.agents[0].airframe.inertia_kg_m2 /= 30;  // so that the rotors can often give all of the torque
    e.agents[0].control.heading_rad = within(0.2);
    e.agents[0].v_W = vector(1);
    const double roll = within(0.1), pitch = within(0.1), yaw = within(0.2);
    Motion self = Tilted(e, roll, pitch, yaw);
    self.p_WB += vector(0.5);
    self.v_WB += vector(0.3);
    self.w_WB_B = vector(0.2);
    const Vector3d u_W(within(5), within(5), within(trial % 2 == 0 ? 5 : 20));
    const Eigen::Vector4d expected = AsDocumented(e, self, u_W, roll, pitch, yaw);
    const Controller::Output output = First(e, self, u_W);
    const double t_max = e.agents[0].airframe.max_thrust_n;
    EXPECT_NEAR(WrenchOf(e, output)[0], std::clamp(expected[0], 0.1 * t_max, 0.9 * t_max), 1e-9);
    kept += expected[0] < 0.1 * t_max || expected[0] > 0.9 * t_max;
    if ((output.flags & kRotorLimited) != 0) continue;
    EXPECT_LT((WrenchOf(e, output) - expected).norm(), 1e-9);
    ++free;
  }
  EXPECT_GT(free, 100) << "all four were compared";
  EXPECT_GT(kept, 100) << "the thrust was out of its range";
}

// --- mixer ------------------------------------------------------------------------------------------

/// What the mixer makes of a thrust (N) and torques (N m): the answer of a stack that wants just these, of a level body
/// without gains but for the rates.
Controller::Output Mix(double thrust_n, const Vector3d& tau_B) {
  Airframe airframe = WithoutDrag();
  airframe.position = airframe.altitude = {0, 0};
  airframe.attitude = airframe.heading = {0, 1};
  Experiment e = One(airframe);
  e.agents[0].law.axes = Axes::kXyz;
  Motion self = AtStart(e);
  self.w_WB_B = -tau_B.cwiseQuotient(airframe.inertia_kg_m2);
  return First(e, self, {0, 0, thrust_n / airframe.mass_kg - kG});
}

/// Thrust (N) and torques (N m) of the mixed rotor speeds.
Eigen::Vector4d Mixed(double thrust_n, const Vector3d& tau_B) { return WrenchOf(One(), Mix(thrust_n, tau_B)); }

TEST(Mixer, GivesWhatTheRotorsCan) {
  const Vector3d tau_B(0.5, -0.7, 0.05);
  const Eigen::Vector4d mixed = Mixed(14, tau_B);
  EXPECT_NEAR(mixed[0], 14, 1e-9);
  EXPECT_LT((mixed.tail<3>() - tau_B).norm(), 1e-9);
  EXPECT_EQ(Mix(14, tau_B).flags, 0u);
}

TEST(Mixer, KeepsThrustAndTheDirectionOfATiltThatIsTooMuch) {
  const Eigen::Vector4d mixed = Mixed(14, {30, -10, 0});
  EXPECT_NEAR(mixed[0], 14, 1e-9);
  EXPECT_NEAR(mixed[1] / mixed[2], -3, 1e-9);
  EXPECT_NEAR(mixed[1], 14.0 / 4 * 2 * Built("mascot").arm_m, 1e-9) << "the right rotor stands still";
  EXPECT_EQ(Mix(14, {30, -10, 0}).flags, kRotorLimited);
}

TEST(Mixer, GivesUpYawBeforeTilt) {
  const Eigen::Vector4d mixed = Mixed(14, {3, 0, -5});
  EXPECT_NEAR(mixed[1], 3, 1e-9);
  EXPECT_NEAR(mixed[0], 14, 1e-9);
  EXPECT_LT(std::abs(mixed[3]), 0.1);
}

TEST(Mixer, LeavesTheTiltSomeAuthorityAtAnyThrust) {
  EXPECT_NEAR(Mixed(-5, {0.1, 0, 0})[0], 3, 1e-9);
  EXPECT_NEAR(Mixed(-5, {0.1, 0, 0})[1], 0.1, 1e-9);
  EXPECT_NEAR(Mixed(100, {0.1, 0, 0})[0], 27, 1e-9);
  EXPECT_NEAR(Mixed(100, {0.1, 0, 0})[1], 0.1, 1e-9);
}

// --- several at once --------------------------------------------------------------------------------

/// Quadrotors that differ in whatever a stack knows, and any motions of them.
struct Different {
  explicit Different(unsigned seed, int count) : random(seed) {
    e = Bodies("quadrotor", std::vector<Vector3d>(static_cast<std::size_t>(count), {1, 2, 3}));
    for (AgentConfig& agent : e.agents) {
      agent.airframe = Built(std::vector{"mascot", "crazyflie", "mascot_published"}[random() % 3]);
      agent.law.axes = random() % 2 == 0 ? Axes::kXy : Axes::kXyz;
      agent.control.inversion = random() % 2 == 0 ? Inversion::kExact : Inversion::kSmallAngle;
      agent.control.heading_rad = random() % 4 == 0 ? 50 : 3;
      agent.control.drag_compensation = random() % 2 == 0;
    }
    motions.resize(e.agents.size());
    wanted_W.resize(e.agents.size());
  }
  void Draw() {
    std::normal_distribution<double> normal;
    const auto draw = [&](double scale) -> Vector3d {
      return Vector3d(normal(random), normal(random), normal(random)) * scale;
    };
    for (std::size_t i = 0; i < motions.size(); ++i) {
      motions[i].p_WB = e.agents[i].p_W + draw(0.05);
      motions[i].v_WB = draw(0.3);
      motions[i].w_WB_B = draw(1);
      motions[i].q_WB =
          Eigen::Quaterniond(1, 0.3 * normal(random), 0.3 * normal(random), 3 * normal(random)).normalized();
      wanted_W[i] = draw(2);
    }
  }

  std::mt19937_64 random;
  Experiment e;
  std::vector<Motion> motions;
  std::vector<Vector3d> wanted_W;
};

TEST(QuadrotorController, GivesTheSameBitsWithAnyNumberOfLanes) {
  int tilt_limited = 0, rotor_limited = 0, free = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int count = 1 + static_cast<int>(seed) % 9;
    Different different(seed, count);
    std::vector<int> ids(different.motions.size());
    std::iota(ids.begin(), ids.end(), 1);
    std::vector<ControllerOfOne> alone;
    for (const int id : ids) alone.emplace_back(different.e, id);
    std::vector<std::unique_ptr<Controller>> together;
    for (const int lanes : LanesOfQuadrotors()) together.push_back(MakeQuadrotorController(different.e, ids, lanes));
    for (int tick = 0; tick < 50; ++tick) {
      different.Draw();
      std::vector<Controller::Input> inputs;
      for (std::size_t i = 0; i < ids.size(); ++i) inputs.push_back({&different.motions[i], different.wanted_W[i]});
      std::vector<Controller::Output> expected;
      for (std::size_t i = 0; i < ids.size(); ++i)
        expected.push_back(alone[i].Actuate(different.motions[i], different.wanted_W[i]));
      for (const auto& controller : together) {
        std::vector<Controller::Output> outputs(ids.size());
        controller->Actuate(inputs, outputs);
        for (std::size_t i = 0; i < ids.size(); ++i) {
          ASSERT_EQ(outputs[i].actuator, expected[i].actuator) << "seed " << seed << ", agent " << ids[i];
          ASSERT_EQ(outputs[i].flags, expected[i].flags) << "seed " << seed << ", agent " << ids[i];
        }
      }
      for (const Controller::Output& output : expected) {
        tilt_limited += (output.flags & kTiltLimited) != 0;
        rotor_limited += (output.flags & kRotorLimited) != 0;
        free += output.flags == 0;
      }
    }
  }
  EXPECT_GT(tilt_limited, 100);
  EXPECT_GT(rotor_limited, 100);
  EXPECT_GT(free, 100);
}

TEST(QuadrotorController, TurnsTheShorterWayToAnyHeading) {
  for (const double heading_rad : {-400.0, -9.0, -3.0, 0.1, 2.0, 3.1, 6.0, 50.0}) {
    Airframe airframe = WithoutDrag();
    airframe.position = airframe.altitude = {0, 0};
    airframe.heading = {1, 0};
    Experiment e = One(airframe);
    e.agents[0].control.heading_rad = heading_rad;
    Motion self = AtStart(e);
    self.q_WB = Eigen::AngleAxisd(-0.5, Vector3d::UnitZ());
    const double expected = std::remainder(heading_rad + 0.5, 2 * std::numbers::pi);
    // As far as the rotors go: it turns that way.
    const double torque = WrenchOf(e, First(e, self))[3] / airframe.inertia_kg_m2.z();
    EXPECT_EQ(torque > 0, expected > 0) << heading_rad;
    EXPECT_LE(std::abs(torque), std::abs(expected) + 1e-9) << heading_rad;
  }
}

TEST(LowLevel, ActuatesEachAgentByItsModel) {
  Experiment e = Bodies("quadrotor", {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}, {4, 0, 1}});
  e.agents[1].model = "double_integrator";
  e.agents[2].model = "unicycle";
  e.agents[4].model = "single_integrator";
  const std::vector<int> ids = {2, 3, 4, 5};
  LowLevel low_level(e, {2, 5});
  std::vector<Motion> motions(ids.size());
  std::vector<Controller::Input> inputs;
  std::vector<Command> commands(ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k) {
    motions[k].p_WB = e.agent(ids[k]).p_W;
    inputs.push_back({&motions[k], {1, 0.1, 0}});
    commands[k].flags = kSpeedLimited;
  }
  low_level.Actuate(inputs, commands);
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const Controller::Output alone = ControllerOfOne(e, ids[k]).Actuate(motions[k], {1, 0.1, 0});
    EXPECT_EQ(commands[k].actuator, alone.actuator) << ids[k];
    EXPECT_EQ(commands[k].flags, alone.flags | kSpeedLimited) << ids[k];
  }
}

// --- closed loop ------------------------------------------------------------------------------------

using LawOfAll = std::function<Vector3d(std::size_t i, const std::vector<Motion>& all)>;

struct Flight {
  std::vector<std::vector<Motion>> rows;
  double rms_from_ideal_m = 0;  // like fidelity.rms_m of the summary
  double travelled_m = 0;
};

/// Simulates `e` for `duration_s` under `law`, limited per axis, and ideal double integrators under the same law.
Flight Fly(const Experiment& e, double duration_s, double limit, const LawOfAll& law) {
  World world(e);
  const auto n = e.agents.size();
  std::vector<ControllerOfOne> controllers;
  std::vector<Motion> all, ideal;
  for (const AgentConfig& agent : e.agents) {
    controllers.emplace_back(e, agent.id);
    all.push_back(world.State(agent.id));
  }
  ideal = all;
  const auto limited = [&](Vector3d a_W) {
    if (e.agents[0].law.axes == Axes::kXy) a_W.z() = 0;
    return Vector3d(a_W.cwiseMax(-limit).cwiseMin(limit));
  };
  Flight flight{{all}};
  const double h = e.period_s();
  const auto ticks = static_cast<int>(std::lround(duration_s / h));
  double squares = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    std::vector<Actuation> commands(n);
    std::vector<Vector3d> u(n);
    for (std::size_t i = 0; i < n; ++i) {
      commands[i] = controllers[i].Actuate(all[i], limited(law(i, all))).actuator;
      u[i] = limited(law(i, ideal));
    }
    world.Step(commands);
    for (std::size_t i = 0; i < n; ++i) {
      const Motion now = world.State(static_cast<int>(i) + 1);
      flight.travelled_m += (now.p_WB - all[i].p_WB).norm() / static_cast<double>(n);
      all[i] = now;
      ideal[i].p_WB += h * ideal[i].v_WB + h * h / 2 * u[i];
      ideal[i].v_WB += h * u[i];
      squares += (all[i].p_WB - ideal[i].p_WB).squaredNorm();
    }
    flight.rows.push_back(all);
  }
  flight.rms_from_ideal_m = std::sqrt(squares / static_cast<double>(n) / (ticks + 1));
  return flight;
}

/// PD law to the waypoint `goal`.
LawOfAll Towards(const Vector3d& goal, double p_gain, double d_gain) {
  return [=](std::size_t i, const std::vector<Motion>& all) -> Vector3d {
    return p_gain * (goal - all[i].p_WB) - d_gain * all[i].v_WB;
  };
}

TEST(ClosedLoop, StepsTwentyMetresWithoutOvershootAndWithoutError) {
  for (const Inversion inversion : {Inversion::kSmallAngle, Inversion::kExact}) {
    Experiment e = Bodies("quadrotor", {{0, 0, 1}});
    e.agents[0].control.inversion = inversion;
    const Flight flight = Fly(e, 40, 2, Towards({20, 0, 1}, 0.6, 1.5));
    double highest = 0, settled_s = 0;
    for (std::size_t k = 0; k < flight.rows.size(); ++k) {
      const double x = flight.rows[k][0].p_WB.x();
      highest = std::max(highest, x);
      if (std::abs(x - 20) > 0.02 * 20) settled_s = static_cast<double>(k + 1) * e.period_s();
    }
    EXPECT_LT(highest, 20 * 1.02);
    EXPECT_LT(settled_s, 12);
    EXPECT_LT((flight.rows.back()[0].p_WB - Vector3d(20, 0, 1)).norm(), 1e-6);
  }
}

TEST(ClosedLoop, AcceleratesAsToldWhileThePapersInversionSagsLittle) {
  for (const Inversion inversion : {Inversion::kSmallAngle, Inversion::kExact}) {
    Experiment e = Bodies("quadrotor", {{0, 0, 5}});
    e.agents[0].control.inversion = inversion;
    const Flight flight = Fly(e, 4, 3, [](std::size_t, const auto&) { return Vector3d(2, -1, 0); });
    EXPECT_NEAR(flight.rows.back()[0].a_WB.x(), 2, 0.01);
    EXPECT_NEAR(flight.rows.back()[0].a_WB.y(), -1, 0.01);
    const double sag_m = 5 - flight.rows.back()[0].p_WB.z();
    EXPECT_NEAR(sag_m, 0, inversion == Inversion::kExact ? 1e-4 : 0.02);
  }
}

TEST(ClosedLoop, EveryAirframeFliesToItsGoalInThreeDimensions) {
  for (const Airframe& airframe : Airframes()) {
    Experiment e = Bodies("quadrotor", {{0, 0, 1}}, airframe);
    e.agents[0].law.axes = Axes::kXyz;
    const Flight flight = Fly(e, 60, 0.6, Towards({4, -3, 3}, 0.25, 1.0));
    EXPECT_LT((flight.rows.back()[0].p_WB - Vector3d(4, -3, 3)).norm(), 1e-3) << airframe.name;
    EXPECT_LT(flight.rows.back()[0].v_WB.norm(), 1e-3) << airframe.name;
  }
}

TEST(ClosedLoop, TurnsToItsHeadingAndStillFliesStraight) {
  Experiment e = Bodies("quadrotor", {{0, 0, 1}});
  e.agents[0].control.heading_rad = 2.0;
  const Flight flight = Fly(e, 40, 2, Towards({10, 0, 1}, 0.25, 1.0));
  double sideways_m = 0;
  for (const auto& row : flight.rows) sideways_m = std::max(sideways_m, std::abs(row[0].p_WB.y()));
  EXPECT_LT(sideways_m, 0.05);
  const Vector3d x_B = flight.rows.back()[0].q_WB * Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(x_B.y(), x_B.x()), 2.0, 1e-3);
}

/// Four quadrotors at random positions and different heights.
Experiment Four(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Vector3d> places;
  for (int i = 0; i < 4; ++i) {
    const auto coordinate = [&] { return 20 * (static_cast<double>(random() >> 11) * 0x1p-53) - 10; };
    const double x = coordinate();
    places.emplace_back(x, coordinate(), 1.0 + i);
  }
  return Bodies("quadrotor", places);
}

TEST(ClosedLoop, ConsensusFollowsTheIdealDoubleIntegratorWithinThreeThousandthsOfTheWay) {
  const LawOfAll consensus = [](std::size_t i, const std::vector<Motion>& all) -> Vector3d {
    Vector3d a_W = -0.7 * all[i].v_WB;
    for (const Motion& other : all) a_W += 0.03 * (other.p_WB - all[i].p_WB);
    return a_W;
  };
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Flight flight = Fly(Four(seed), 40, 3, consensus);
    EXPECT_LT(flight.rms_from_ideal_m, 0.003 * flight.travelled_m);
    const std::vector<Motion>& end = flight.rows.back();
    for (const Motion& agent : end) {
      EXPECT_LT((agent.p_WB - end[0].p_WB).head<2>().norm(), 0.01);
      EXPECT_LT(agent.v_WB.norm(), 0.01);
    }
  }
}

TEST(ClosedLoop, MinMaxMeetsARestingParentInTimeAndThenStaysWithinFiveCentimetres) {
  const double beta_c = 1.0, beta_p = 0.5, z0 = 10, a = beta_c - beta_p;
  const LawOfAll min_max = [=](std::size_t i, const std::vector<Motion>& all) -> Vector3d {
    if (i == 0) return Vector3d::Zero();
    const Vector3d z = all[1].p_WB - all[0].p_WB, w = all[1].v_WB - all[0].v_WB;
    return -beta_c * (2 * a * z + w.cwiseProduct(w.cwiseAbs())).cwiseSign();
  };
  const Flight flight = Fly(Bodies("quadrotor", {{0, 0, 1}, {z0, 0, 3}}), 30, 3, min_max);
  const double ideal_s = std::sqrt(2 * z0 * (1 / a + 1 / beta_c));
  for (auto k = static_cast<std::size_t>(1.15 * ideal_s * 100); k < flight.rows.size(); ++k)
    ASSERT_LT((flight.rows[k][1].p_WB - flight.rows[k][0].p_WB).head<2>().norm(), 0.05) << "tick " << k;
}

TEST(ClosedLoop, ABangBangLawBeyondTheRotorsMeansNeverTumblesTheBody) {
  const LawOfAll chatter = [](std::size_t, const std::vector<Motion>& all) -> Vector3d {
    return -2.5 * (all[0].p_WB + 0.1 * all[0].v_WB).cwiseSign();  // little damping: oscillates at the limit
  };
  const Flight flight = Fly(Bodies("quadrotor", {{3, -2, 2}}), 60, 3, chatter);
  for (const auto& row : flight.rows) ASSERT_GT((row[0].q_WB * Vector3d::UnitZ()).z(), std::cos(1.0));
}

}  // namespace
}  // namespace mascot
