// Unicycles in cyclic pursuit: what their wheels are told, and the polygons on which they end.
#include "agent/laws/cyclic_pursuit/unicycle_pursuit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <numbers>

#include "agent/controller.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

/// Five unicycles on a circle of `radius_m`, counterclockwise, that head along it. `law`: lines of [law].
std::string Circle(double radius_m, const std::string& law, double duration_s = 60) {
  std::string positions, headings;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * std::numbers::pi * i / 5 + 0.05 * (i % 2);
    positions +=
        fmt::format("{}[{}, {}, 1.0]", i == 0 ? "" : ", ", radius_m * std::cos(angle), radius_m * std::sin(angle));
    headings += fmt::format("{}{}", i == 0 ? "" : ", ", angle + std::numbers::pi / 2);
  }
  return "[run]\nduration_s = " + ShortestFloat(duration_s) +
         "\n[physics]\ncollisions = false\n[agents]\ncount = 5\nmodel = 'unicycle'\nposition_m = [" + positions +
         "]\nheading_rad = [" + headings + "]\n[graph]\ntopology = 'ring'\n[law]\nname = 'cyclic_pursuit'\n" + law;
}

TEST(UnicyclePursuit, TellsTheWheelsTheSpeedAndTheTurningSpeedOfThePaper) {
  for (const std::string pursuit : {"constant_speed", "proportional_speed"})
    for (const double angle : {-3.0, -1.0, 0.0, 0.4, 2.5}) {
      const Experiment experiment = LoadExperiment(
          Section::FromText(
              Circle(1, "pursuit = '" + pursuit + "'\ngain = 0.3\nturn_gain = 0.7\nspeed_m_per_s = 0.6\n"),
              "test.toml"),
          "test");
      const auto law = MakeLaw(experiment, 1);
      ControllerOfOne controller(experiment, 1);
      Motion self, other;
      const double heading = 0.8, distance_m = 2.5;
      self.p_WB = {1, -2, 1};
      self.q_WB = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ());
      other.p_WB = self.p_WB + distance_m * Eigen::Vector3d(std::cos(heading + angle), std::sin(heading + angle), 0);
      const Heard heard{.id = 2, .weight = 1, .motion = other, .age_s = 0, .message = {}};
      const Actuation told = controller.Actuate(self, law->Want_W(0, self, {&heard, 1})).actuator;
      EXPECT_NEAR(told[0], pursuit == "constant_speed" ? 0.6 : 0.3 * distance_m, 1e-12) << angle;
      EXPECT_NEAR(told[1], 0.7 * angle, 1e-12) << pursuit;
    }
}

TEST(UnicyclePursuit, AtConstantSpeedEndsOnTheCircleOfTheEquilibrium) {
  for (const double start_m : {0.7, 1.1}) {
    const LawRun run(Circle(start_m, "pursuit = 'constant_speed'\nspeed_m_per_s = 0.5\n"));
    EXPECT_NEAR(run.Measured("radius_m"), 5 * 0.5 / std::numbers::pi, 0.01) << "N speed / (pi turn_gain)";
    EXPECT_NEAR(run.Measured("turn_rate_rad_per_s"), std::numbers::pi / 5, 0.01) << "each turns by turn_gain pi / N";
    EXPECT_EQ(run.prediction.silent, "the closed form is of single integrators");
  }
}

TEST(UnicyclePursuit, AtASpeedLikeTheDistanceClosesInOrPartsAsTheRatioOfTheGainsSays) {
  const double border = 2 * 5 * 0.3 * std::sin(std::numbers::pi / 5) / std::numbers::pi;
  const auto ratio = [](double turn_gain) {
    return LawRun(Circle(2,
                         "pursuit = 'proportional_speed'\ngain = 0.3\nturn_gain = " + ShortestFloat(turn_gain) + "\n",
                         30))
        .Measured("radius_ratio");
  };
  EXPECT_LT(ratio(1.2 * border), 0.5);
  EXPECT_NEAR(ratio(border), 1, 0.1);
  EXPECT_GT(ratio(0.8 * border), 2);
}

TEST(UnicyclePursuit, ByTheLinearLawIsAsItWas) {
  const LawRun run(Circle(2, "gain = 0.3\n", 40));
  EXPECT_LT(run.Measured("radius_ratio"), 0.1) << "the law of points, to which a unicycle is turned: they meet";
}

}  // namespace
}  // namespace mascot
