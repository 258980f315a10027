// The model of a quadrotor by which theory predicts, against flight in Bullet: steps and swings of the command.
#include "orchestrator/theory/low_level_loops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <string>

#include "agent/controller.h"
#include "physics_server/world.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using Wanted = std::function<Eigen::Vector3d(double t_s)>;  // acceleration (m/s^2)

std::string OneQuadrotor(const std::string& airframe, const std::string& more = "") {
  return "[run]\nduration_s = 10.0\n[agents]\ncount = 1\nairframe = '" + airframe +
         "'\nposition_m = [[0, 0, 5]]\n[law]\nname = 'consensus'\n" + more;
}

/// The farthest that body and model are apart, in place (m) and in velocity (m/s), under the same commands.
struct Apart {
  double place_m = 0, speed = 0;
};

Apart FlyBoth(const std::string& toml, const Wanted& request, double duration_s, const LoopError& error = {}) {
  const Experiment experiment = Load(toml);
  World world(experiment);
  ControllerOfOne controller(experiment, 1);
  LowLevelLoops loop(experiment, error);
  Apart apart;
  for (std::int64_t tick = 0; experiment.time_s(tick) < duration_s; ++tick) {
    Command command;
    command.a_limited_W = request(experiment.time_s(tick));
    const Actuation actuation[] = {controller.Actuate(world.State(1), command.a_limited_W).actuator};
    world.Step(actuation);
    loop.Step({&command, 1});
    const Motion body = world.State(1), model = loop.motions()[0];
    apart.place_m = std::max(apart.place_m, (body.p_WB - model.p_WB).norm());
    apart.speed = std::max(apart.speed, (body.v_WB - model.v_WB).norm());
  }
  return apart;
}

class LowLevelLoopsOf : public testing::TestWithParam<std::string> {};

TEST_P(LowLevelLoopsOf, AnswersASmallStepAsTheBodyDoes) {
  const Wanted step = [](double t_s) { return Eigen::Vector3d(t_s < 2 ? 0.2 : 0, t_s < 1 ? -0.1 : 0, 0); };
  const Apart apart = FlyBoth(OneQuadrotor(GetParam()), step, 4);  // by then it has flown 1.2 m
  EXPECT_LT(apart.place_m, 0.005);
  EXPECT_LT(apart.speed, 0.005);
}

TEST_P(LowLevelLoopsOf, AnswersAStepThatCutsTorqueAndRateOfTurning) {
  const Wanted jumps = [](double t_s) { return Eigen::Vector3d(std::fmod(t_s, 2) < 1 ? 0.9 : -0.9, 0, 0); };
  const Apart apart = FlyBoth(OneQuadrotor(GetParam()), jumps, 6);
  EXPECT_LT(apart.place_m, 0.03);
  EXPECT_LT(apart.speed, 0.03) << "it swings by 0.45 m/s";
}

TEST_P(LowLevelLoopsOf, AnswersASwingInSpace) {
  const Wanted swing = [](double t_s) {
    return Eigen::Vector3d(0.3 * std::cos(2 * t_s), 0.3 * std::sin(2 * t_s), 0.2 * std::sin(t_s));
  };
  const Apart apart = FlyBoth(OneQuadrotor(GetParam(), "axes = 'xyz'\n"), swing, 10);
  EXPECT_LT(apart.place_m, 0.02);
  EXPECT_LT(apart.speed, 0.02);
}

TEST_P(LowLevelLoopsOf, IsBlownOffAsTheBodyIsAndInvertsItsTiltAsItsStackDoes) {
  const Wanted swing = [](double t_s) { return Eigen::Vector3d(0.3 * std::cos(t_s), 0.3 * std::sin(t_s), 0); };
  const Apart apart = FlyBoth(OneQuadrotor(GetParam(),
                                           "[physics.wind]\nmean_m_per_s = [1.0, -0.5, 0.0]\n[control]\ninversion = "
                                           "'exact'\ndrag_compensation = false\n"),
                              swing, 10);
  EXPECT_LT(apart.place_m, 0.02);
  EXPECT_LT(apart.speed, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Airframes, LowLevelLoopsOf, testing::Values("mascot", "mascot_published", "crazyflie"),
                         [](const auto& of) { return of.param; });

/// v = G a for a small swing of the command at w (rad/s): the tilt's PD law, and the reference with gains kp', kd':
///   b = H a*,  H = kp / (s^2 + kd s + kp),  a* = a + (kd' + kp' / s) (a / s - v),  s v = b,  s = i w
std::complex<double> Response(const Airframe& body, double w) {
  const std::complex<double> s(0, w);
  const std::complex<double> tilt = body.attitude.kp / (s * s + body.attitude.kd * s + body.attitude.kp);
  const std::complex<double> pull = body.position.kd + body.position.kp / s;
  return tilt * (1.0 + pull / s) / (s + tilt * pull);
}

TEST(LowLevelLoops, SwingsAsTheClosedFormOfItsPolesSays) {
  const Experiment experiment = Load(OneQuadrotor("mascot", "[control]\nrate_hz = 1000\n"));
  for (const double w : {0.5, 2.0, 5.0}) {
    LowLevelLoops loop(experiment, {});
    std::complex<double> sum = 0;
    const double h = experiment.period_s(), period_s = 2 * std::acos(-1.0) / w, forgotten_s = 12;
    std::int64_t tick = 0, used = 0;
    for (; tick * h < forgotten_s + period_s; ++tick) {
      Command command;
      command.a_limited_W.x() = 0.05 * std::cos(w * static_cast<double>(tick) * h);
      if (tick * h >= forgotten_s) {
        sum += loop.motions()[0].v_WB.x() * std::exp(std::complex<double>(0, -w * static_cast<double>(tick) * h));
        ++used;
      }
      loop.Step({&command, 1});
    }
    const std::complex<double> swing = 2.0 * sum / static_cast<double>(used) / 0.05;
    EXPECT_LT(std::abs(swing - Response(experiment.agent(1).airframe, w)), 0.02 / w) << w << " rad/s";
  }
}

TEST(LowLevelLoops, DoubleIntegratorsMoveExactlyAsCommanded) {
  const Experiment experiment =
      Load("[run]\nduration_s = 1.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\n[law]\nname = 'consensus'\n");
  LowLevelLoops loop(experiment, {});
  Command command;
  command.a_limited_W = {1, -2, 0};
  for (int k = 0; k < 100; ++k) loop.Step({&command, 1});
  EXPECT_LT((loop.motions()[0].v_WB - Eigen::Vector3d(1, -2, 0)).norm(), 1e-9);
  EXPECT_LT((loop.motions()[0].p_WB - experiment.agent(1).p_W - Eigen::Vector3d(0.5, -1, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace mascot
