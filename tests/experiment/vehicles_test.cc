// [[vehicles]]: which agent has which vehicle, and what its keys make of it.
#include "experiment/vehicles.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/support/load.h"

namespace mascot {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;

Experiment Team(const std::string& vehicles) {
  return Load(
      "[run]\nmode = 'realtime'\nduration_s = 10.0\n[agents]\ncount = 4\n"
      "position_m = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 2.0, 1.0], [2.0, 2.0, 1.0]]\n" +
      vehicles);
}

VehicleConfig VehicleOf(const std::string& keys, int agent = 2) {
  return Team("[[vehicles]]\nagents = [1, 2]\n" + keys).agent(agent).vehicle.value();
}

TEST(VehicleKeys, BelongToTheirAgents) {
  EXPECT_THAT(AgentsWithVehicles(Team("")), ElementsAre());
  EXPECT_THAT(AgentsWithVehicles(Team("[[vehicles]]\nagents = '1,3-4'\nkind = 'px4'\n")), ElementsAre(1, 3, 4));
  const Experiment two =
      Team("[[vehicles]]\nagents = [3]\nkind = 'px4'\n[[vehicles]]\nagents = [1]\nkind = 'ardupilot'\n");
  EXPECT_EQ(two.agent(3).vehicle->kind, VehicleKind::kPx4);
  EXPECT_EQ(two.agent(1).vehicle->kind, VehicleKind::kArdupilot);
  EXPECT_FALSE(two.agent(2).vehicle);
}

TEST(VehicleKeys, HaveDefaultsOfTheirKind) {
  const VehicleConfig px4 = VehicleOf("kind = 'px4'\n");
  EXPECT_EQ(px4.name_space, "px4_2");
  EXPECT_EQ(px4.system_id, 3) << "that of instance 2";
  EXPECT_EQ(px4.domain, 0);
  EXPECT_EQ(px4.setpoint, SetpointKind::kReference);
  EXPECT_EQ(px4.origin_W, Vector3d(2, 0, 0)) << "below the start";
  EXPECT_EQ(px4.takeoff_m, 1);
  EXPECT_EQ(px4.max_error_m, 1);
  EXPECT_EQ(px4.on_loss, OnVehicleLoss::kLand);
  EXPECT_FALSE(px4.fence_W);
  EXPECT_EQ(VehicleOf("kind = 'crazyswarm'\n").name_space, "cf2");
  const VehicleConfig ardupilot = Team("[[vehicles]]\nagents = [2]\nkind = 'ardupilot'\n").agent(2).vehicle.value();
  EXPECT_EQ(ardupilot.name_space, "ap");
  EXPECT_EQ(ardupilot.setpoint, SetpointKind::kVelocity);
  EXPECT_EQ(ardupilot.system_id, 2);
}

TEST(VehicleKeys, HaveWhatTheirKeysSay) {
  const std::string px4 = "kind = 'px4'\n";
  EXPECT_EQ(VehicleOf(px4 + "namespace = 'uav_{i}'\n").name_space, "uav_2");
  EXPECT_EQ(VehicleOf(px4 + "system_id = 10\n", 1).system_id, 10);
  EXPECT_EQ(VehicleOf(px4 + "system_id = 10\n", 2).system_id, 11) << "the others count on";
  EXPECT_EQ(VehicleOf(px4 + "domain = 42\n").domain, 42);
  EXPECT_EQ(VehicleOf(px4 + "address = '127.0.0.1'\n").address, "127.0.0.1");
  EXPECT_EQ(VehicleOf(px4 + "setpoint = 'velocity'\n").setpoint, SetpointKind::kVelocity);
  EXPECT_EQ(VehicleOf(px4 + "setpoint = 'acceleration'\n").setpoint, SetpointKind::kAcceleration);
  EXPECT_EQ(VehicleOf(px4 + "origin = 'shared'\n").origin_W, Vector3d(0, 0, 0));
  EXPECT_EQ(VehicleOf(px4 + "origin = [1.0, 2.0, 3.0]\n").origin_W, Vector3d(1, 2, 3));
  EXPECT_EQ(VehicleOf(px4 + "yaw_rad = 0.5\n").yaw_rad, 0.5);
  EXPECT_EQ(VehicleOf(px4 + "takeoff_m = 2.5\n").takeoff_m, 2.5);
  EXPECT_EQ(VehicleOf(px4 + "max_error_m = 0.3\n").max_error_m, 0.3);
  EXPECT_EQ(VehicleOf(px4 + "on_loss = 'hold'\n").on_loss, OnVehicleLoss::kHold);
  const VehicleConfig fenced = VehicleOf(px4 + "fence = [[-1.0, -2.0, 0.0], [1.0, 2.0, 3.0]]\n");
  EXPECT_EQ(fenced.fence_W->min(), Vector3d(-1, -2, 0));
  EXPECT_EQ(fenced.fence_W->max(), Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace mascot
