// What the orchestrator knows of vehicles, and what follows for the others.
#include "orchestrator/engines/dds/fleet.h"

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "tests/support/load.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class FleetTest : public ::testing::Test {
 protected:
  void Says(int agent, FlightPhase phase, const std::string& words) {
    mascot_msgs::msg::VehicleStatus status;
    status.agent(static_cast<std::uint32_t>(agent));
    status.phase(static_cast<std::uint8_t>(phase));
    status.battery(std::numeric_limits<double>::quiet_NaN());
    status.number(++number_);
    status.words(words);
    fleet_.Take(status);
  }
  void AllAre(FlightPhase phase) {
    for (int agent = 1; agent <= 3; ++agent) Says(agent, phase, std::string(kFlightPhases.Name(phase)));
    fleet_.TakeNews();
  }
  std::vector<std::string> Orders() {
    now_ += 1s;
    std::vector<std::string> orders;
    for (const Fleet::Order& order : fleet_.Orders(now_)) {
      std::string text = order.ask == Ask::kStart ? "start" : order.ask == Ask::kLand ? "land" : "stop";
      for (const std::uint32_t agent : order.agents) text += " " + std::to_string(agent);
      orders.push_back(text + ": " + order.reason);
    }
    return orders;
  }

  const Experiment experiment_ = Load(
      "[run]\nduration_s = 1.0\nmode = 'realtime'\n[agents]\ncount = 4\nmodel = 'double_integrator'\n[graph]\ntopology "
      "= "
      "'path'\n[[vehicles]]\nagents = [1, 2]\nkind = 'px4'\n[[vehicles]]\nagents = [3]\nkind = 'px4'\non_loss = "
      "'hold'\n");
  Fleet fleet_{experiment_};
  std::uint64_t number_ = 0;
  Fleet::Time now_ = {};
};

TEST_F(FleetTest, StartsOnlyIfAllAreThereAndAsksOnce) {
  EXPECT_THAT([&] { fleet_.Start(); }, ThrowsMessage<std::invalid_argument>(
                                           "start: expected all vehicles to be there, got none of vehicles 1, 2, 3"));
  Says(1, FlightPhase::kFound, "found: PX4");
  Says(3, FlightPhase::kFound, "found: PX4");
  EXPECT_THAT([&] { fleet_.Start(); },
              ThrowsMessage<std::invalid_argument>("start: expected all vehicles to be there, got none of vehicle 2"));
  EXPECT_FALSE(fleet_.AreFound());
  Says(2, FlightPhase::kFound, "found: PX4");
  EXPECT_TRUE(fleet_.AreFound());
  EXPECT_EQ(fleet_.Start(), "vehicles 1, 2, 3 start");
  EXPECT_THAT(Orders(), ElementsAre("start 1 2 3: asked to start"));
  EXPECT_THAT(Orders(), IsEmpty()) << "what a vehicle refuses is for people to ask again";
  AllAre(FlightPhase::kReady);
  EXPECT_TRUE(fleet_.AreReady());
  EXPECT_THAT([&] { fleet_.Start(); },
              ThrowsMessage<std::invalid_argument>("start: expected vehicles that stand on the ground, got none"));
}

TEST_F(FleetTest, SaysWhatARunWaitsForAndWhenThatIsInVain) {
  EXPECT_EQ(fleet_.Awaited(), "vehicles 1, 2, 3 are absent");
  AllAre(FlightPhase::kFound);
  Says(2, FlightPhase::kArmed, "armed");
  EXPECT_EQ(fleet_.Awaited(), "vehicles 1, 3 are found, vehicle 2 is armed");
  Says(1, FlightPhase::kReady, "ready");
  Says(2, FlightPhase::kFlying, "flying");
  EXPECT_EQ(fleet_.Awaited(), "vehicle 3 is found");
  Says(3, FlightPhase::kReady, "ready");
  EXPECT_EQ(fleet_.Awaited(), "all vehicles are ready, and the first tick is to come");
  EXPECT_EQ(fleet_.WhyNotToBegin(), "");
  Says(1, FlightPhase::kLanding, "landing: its battery is at 12 %");
  EXPECT_EQ(fleet_.WhyNotToBegin(), "") << "all shall be told that it has landed";
  Says(1, FlightPhase::kLanded, "landed");
  Says(3, FlightPhase::kLost, "lost: it has disarmed itself");
  EXPECT_EQ(fleet_.WhyNotToBegin(), "vehicle 1 is landed, vehicle 3 is lost");
}

TEST_F(FleetTest, AsksToLandUntilTheyDo) {
  EXPECT_THAT([&] { fleet_.Land(0, "enough"); },
              ThrowsMessage<std::invalid_argument>("land: expected a vehicle in the air, got none"));
  AllAre(FlightPhase::kFlying);
  EXPECT_FALSE(fleet_.AreDown());
  EXPECT_EQ(fleet_.Land(0, "enough"), "vehicles 1, 2, 3 land");
  EXPECT_THAT(Orders(), ElementsAre("land 1 2 3: enough"));
  Says(2, FlightPhase::kLanding, "landing: enough");
  EXPECT_THAT(Orders(), ElementsAre("land 1 3: enough"));
  AllAre(FlightPhase::kLanded);
  EXPECT_THAT(Orders(), IsEmpty());
  EXPECT_TRUE(fleet_.AreDown());
}

TEST_F(FleetTest, LandsThoseThatShallWhenAnotherIsLost) {
  AllAre(FlightPhase::kFlying);
  Says(1, FlightPhase::kLost, "lost: it has disarmed itself");
  EXPECT_THAT(Orders(), ElementsAre("land 2: vehicle 1 is lost")) << "vehicle 3 holds";
  const auto news = fleet_.TakeNews();
  ASSERT_EQ(news.size(), 1u);
  EXPECT_EQ(news[0].agent, 1);
  EXPECT_EQ(news[0].words, "lost: it has disarmed itself");
}

TEST_F(FleetTest, AProcessThatEndsIsALossAndSaysNothingMore) {
  AllAre(FlightPhase::kFlying);
  fleet_.OnProcessEnd(3, "was killed by signal 9 (Killed)");
  EXPECT_THAT(Orders(), ElementsAre("land 1 2: vehicle 3 is lost"));
  Says(3, FlightPhase::kFlying, "late words");
  EXPECT_EQ(fleet_.Of(3).phase, FlightPhase::kLost);
  const auto news = fleet_.TakeNews();
  ASSERT_EQ(news.size(), 1u);
  EXPECT_EQ(news[0].words, "lost: its process was killed by signal 9 (Killed)");
}

TEST_F(FleetTest, StopsTheMotorsOfOneUntilItIsDown) {
  AllAre(FlightPhase::kFlying);
  EXPECT_EQ(fleet_.StopMotors(2, "asked to"), "the motors of vehicle 2 are to stop");
  EXPECT_THAT(Orders(), ElementsAre("stop 2: asked to"));
  EXPECT_THAT(Orders(), ElementsAre("stop 2: asked to"));
  Says(2, FlightPhase::kLost, "lost: its motors stand");
  EXPECT_THAT(Orders(), ElementsAre("land 1: vehicle 2 is lost"));
  EXPECT_THAT([&] { fleet_.StopMotors(4, ""); }, ThrowsMessage<std::invalid_argument>("kill: agent 4 has no vehicle"));
}

TEST_F(FleetTest, DoesNotSayThatMotorsStopIfNobodyCanStopThem) {
  AllAre(FlightPhase::kFlying);
  fleet_.OnProcessEnd(1, "was killed by signal 9 (Killed)");
  EXPECT_THAT([&] { fleet_.StopMotors(1, ""); },
              ThrowsMessage<std::invalid_argument>(
                  "kill: the process of vehicle 1 has ended: nobody is there who could stop its motors"));
  Says(2, FlightPhase::kAbsent, "absent");
  EXPECT_THAT([&] { fleet_.StopMotors(2, ""); },
              ThrowsMessage<std::invalid_argument>("kill: nothing is heard of vehicle 2"));
}

TEST_F(FleetTest, RefusesStatusesOfVehiclesThatThereAreNot) {
  EXPECT_THAT([&] { Says(4, FlightPhase::kFound, ""); },
              ThrowsMessage<std::runtime_error>("a status of vehicle 4 in phase 1, which there is not"));
  EXPECT_THAT([&] { Says(1, static_cast<FlightPhase>(10), ""); },
              ThrowsMessage<std::runtime_error>("a status of vehicle 1 in phase 10, which there is not"));
}

}  // namespace
}  // namespace mascot
