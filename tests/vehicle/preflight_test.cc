// What is said of vehicles before a flight.
#include "vehicle/preflight.h"

#include <gmock/gmock.h>

#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PreflightTest : public ::testing::Test {
 protected:
  /// `origin` and more keys of two vehicles, 4 m apart.
  static Experiment Pair(const std::string& more = "") {
    return Load(
        "[run]\nduration_s = 1.0\nmode = 'realtime'\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = "
        "[[0.0, 0.0, 1.0], [4.0, 0.0, 1.0]]\n[graph]\ntopology = 'path'\n[[vehicles]]\nagents = [1, 2]\nkind = "
        "'px4'\n" +
        more);
  }
  /// One that stands in order, at this place of its own frame.
  static VehicleSeen At(int agent, const Eigen::Vector3d& p_L) {
    VehicleSeen seen{.agent = agent, .rate_hz = 100, .age_s = 0.01};
    seen.report.release = "PX4 1.16 or 1.17";
    seen.report.motion_L = Motion{.p_WB = p_L};
    return seen;
  }
  static std::vector<std::string> RefusalsOfTheFirst(const Experiment& experiment, const VehicleSeen& first) {
    return Preflight(experiment, {first, At(2, {0, 0, 0})}).front().refusals;
  }
};

TEST_F(PreflightTest, LetsThoseFlyThatStandWhereTheFileSays) {
  const auto lines = Preflight(Pair(), {At(1, {0.1, 0, 0}), At(2, {0, 0.2, 0})});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[0].refusals, IsEmpty());
  EXPECT_THAT(lines[1].refusals, IsEmpty());
  EXPECT_EQ(lines[0].seen,
            "PX4 1.16 or 1.17, 100.0 Hz, 0.01 s old, at [0.10, 0.00, 0.00], heading 0.00 rad, 0.10 m from its start; "
            "its frame's origin at [0.00, 0.00, 0.00], turned by 0.00 rad; battery unknown");
  EXPECT_EQ(*lines[1].p_W, Eigen::Vector3d(4, 0.2, 0)) << "its origin is at its agent's start";
}

TEST_F(PreflightTest, TellsFrameHeadingAndBattery) {
  VehicleSeen seen = At(1, {0, -0.001, 0});
  seen.report.motion_L->q_WB = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  seen.report.battery = 0.87;
  EXPECT_EQ(Preflight(Pair("origin = [1.0, 2.0, 0.0]\nyaw_rad = 0.25\n"), {seen, At(2, {0, 0, 0})})[0].seen,
            "PX4 1.16 or 1.17, 100.0 Hz, 0.01 s old, at [1.00, 2.00, 0.00], heading 0.75 rad, 2.24 m from its start; "
            "its frame's origin at [1.00, 2.00, 0.00], turned by 0.25 rad; battery 87 %");
}

TEST_F(PreflightTest, RefusesWhatATestPilotWould) {
  const Experiment pair = Pair();
  VehicleSeen absent{.agent = 1};
  EXPECT_THAT(RefusalsOfTheFirst(pair, absent),
              ElementsAre("nothing has been heard of it: are its domain and namespace right?"));
  VehicleSeen dumb{.agent = 1};
  dumb.report.motion_L = Motion();
  EXPECT_THAT(RefusalsOfTheFirst(pair, dumb), ElementsAre("nothing has been heard of its status"));
  VehicleSeen blind{.agent = 1};
  blind.report.release = "PX4 1.18";
  EXPECT_THAT(RefusalsOfTheFirst(pair, blind), ElementsAre("nothing has been heard of where it is"));
  VehicleSeen seen = At(1, {0, 0, 0});
  seen.report.problem = "its heading is unknown";
  EXPECT_THAT(RefusalsOfTheFirst(pair, seen), ElementsAre("its heading is unknown"));
  seen = At(1, {0, 0, 0});
  seen.report.is_armed = true;
  EXPECT_THAT(RefusalsOfTheFirst(pair, seen), ElementsAre("it is armed already"));
  seen = At(1, {0, 0, 0});
  seen.report.battery = 0.2;
  EXPECT_THAT(RefusalsOfTheFirst(pair, seen), ElementsAre("its battery is at 20 %, and 30 % are wanted"));
  seen = At(1, {0, 0, 0});
  seen.age_s = 2;
  seen.rate_hz = 1;
  EXPECT_THAT(RefusalsOfTheFirst(pair, seen), ElementsAre("nothing has been heard of where it is for 2.0 s",
                                                          "it says where it is 1.0 times a second, and 5 are wanted"));
  EXPECT_THAT(RefusalsOfTheFirst(Pair("fence = [[-1.0, -1.0, 0.0], [3.0, 1.0, 0.5]]\n"), At(1, {0, 0, 0})),
              ElementsAre("its start is beyond its fence"));
}

TEST_F(PreflightTest, FindsOriginsThatAreMixedUp) {
  const Experiment shared = Pair("origin = 'shared'\n");
  auto lines = Preflight(shared, {At(1, {0, 0, 0}), At(2, {0.1, 0, 0})});
  EXPECT_THAT(lines[0].refusals, ElementsAre("it is where vehicle 2 is, 0.10 m apart"));
  EXPECT_THAT(lines[1].refusals, ElementsAre(HasSubstr("it is 3.90 m from its start, and 0.5 m are allowed"),
                                             "it is where vehicle 1 is, 0.10 m apart"));
  lines = Preflight(shared, {At(1, {0, 0, 0}), At(2, {9, 0, 0})});
  EXPECT_THAT(lines[0].refusals, ElementsAre("it is 9.00 m from vehicle 2, and the file says 4.00 m"));
}

}  // namespace
}  // namespace mascot
