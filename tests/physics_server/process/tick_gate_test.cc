#include "physics_server/process/tick_gate.h"

#include <gtest/gtest.h>

#include "tests/support/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using Time = TickGate::Time;

constexpr double kPeriod_s = 0.01;

TEST(TickGate, IsOpenUnlessAPaceOrAPauseIsAskedFor) {
  TickGate gate(kPeriod_s, 0);
  EXPECT_TRUE(gate.IsOpen());
  EXPECT_EQ(gate.Opens(kT0), kT0);
  gate.Pause();
  EXPECT_FALSE(gate.IsOpen());
  gate.Resume();
  EXPECT_TRUE(gate.IsOpen());
  EXPECT_FALSE(TickGate(kPeriod_s, 1).IsOpen());
}

TEST(TickGate, OpensEveryPeriodDividedByThePace) {
  TickGate gate(kPeriod_s, 0.5);
  EXPECT_EQ(gate.Opens(kT0), kT0 + 20ms) << "a period after the tick before";
  EXPECT_EQ(gate.Opens(kT0 + 7ms), kT0 + 20ms);
  gate.OnTick(kT0 + 20ms);
  EXPECT_EQ(gate.Opens(kT0 + 20ms), kT0 + 40ms);
  gate.OnTick(kT0 + 45ms);
  EXPECT_EQ(gate.Opens(kT0 + 45ms), kT0 + 60ms) << "5 ms late are made up for";
  gate.OnTick(kT0 + 90ms);
  EXPECT_EQ(gate.Opens(kT0 + 90ms), kT0 + 110ms) << "30 ms are not";
}

TEST(TickGate, APaceNextToNothingHoldsTheTick) {
  for (const double pace : {1e-20, 1e-300, 5e-324}) EXPECT_GT(TickGate(kPeriod_s, pace).Opens(kT0), kT0 + 1h);
}

TEST(TickGate, ANewPaceCountsFromTheTickBefore) {
  TickGate gate(kPeriod_s, 1);
  gate.Opens(kT0);
  gate.OnTick(kT0 + 10ms);
  gate.SetPace(0.25);
  EXPECT_EQ(gate.Opens(kT0 + 12ms), kT0 + 50ms);
  gate.SetPace(10);
  EXPECT_EQ(gate.Opens(kT0 + 13ms), kT0 + 11ms) << "it is due";
  gate.SetPace(0);
  EXPECT_TRUE(gate.IsOpen());
  gate.SetPace(1);
  EXPECT_EQ(gate.Opens(kT0 + 20ms), kT0 + 30ms);
}

TEST(TickGate, APauseHasNoEndUntilSomebodyAsks) {
  TickGate gate(kPeriod_s, 1);
  gate.Opens(kT0);
  gate.Pause();
  EXPECT_EQ(gate.Opens(kT0 + 1h), std::nullopt);
  gate.Resume();
  EXPECT_EQ(gate.Opens(kT0 + 2h), kT0 + 2h + 10ms) << "the time of the pause is not made up for";
}

TEST(TickGate, StepsPassAtOnceAndEndInAPause) {
  TickGate gate(kPeriod_s, 1);
  gate.Opens(kT0);
  gate.Step(2);
  EXPECT_TRUE(gate.paused());
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(gate.Opens(kT0 + 1ms), kT0 + 1ms) << k;
    gate.OnTick(kT0 + 1ms);
  }
  EXPECT_EQ(gate.Opens(kT0 + 1ms), std::nullopt);
  gate.Step(1);
  gate.Pause();
  EXPECT_EQ(gate.Opens(kT0 + 1ms), std::nullopt) << "a pause takes back the steps that are left";
}

TEST(TickGate, APaceThatIsSetInAPauseHoldsAfterIt) {
  TickGate gate(kPeriod_s, 1);
  gate.Pause();
  gate.SetPace(0);
  EXPECT_FALSE(gate.IsOpen());
  EXPECT_EQ(gate.Opens(kT0), std::nullopt);
  gate.Resume();
  EXPECT_TRUE(gate.IsOpen());
}

}  // namespace
}  // namespace mascot
