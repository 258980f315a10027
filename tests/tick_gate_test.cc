#include "physics_server/tick_gate.h"

#include <gtest/gtest.h>

#include "tests/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using Time = TickGate::Time;

constexpr double kPeriod_s = 0.01;

TEST(TickGate, IsOpenUnlessAPaceOrAPauseIsAskedFor) {
  TickGate gate(kPeriod_s, 0);
  EXPECT_TRUE(gate.IsOpen());
  EXPECT_EQ(gate.Opens(kStart), kStart);
  gate.Pause();
  EXPECT_FALSE(gate.IsOpen());
  gate.Resume();
  EXPECT_TRUE(gate.IsOpen());
  EXPECT_FALSE(TickGate(kPeriod_s, 1).IsOpen());
}

TEST(TickGate, OpensEveryPeriodDividedByThePace) {
  TickGate gate(kPeriod_s, 0.5);
  EXPECT_EQ(gate.Opens(kStart), kStart + 20ms) << "a period after the tick before";
  EXPECT_EQ(gate.Opens(kStart + 7ms), kStart + 20ms);
  gate.OnTick(kStart + 20ms);
  EXPECT_EQ(gate.Opens(kStart + 20ms), kStart + 40ms);
  gate.OnTick(kStart + 45ms);
  EXPECT_EQ(gate.Opens(kStart + 45ms), kStart + 60ms) << "5 ms late are made up for";
  gate.OnTick(kStart + 90ms);
  EXPECT_EQ(gate.Opens(kStart + 90ms), kStart + 110ms) << "30 ms are not";
}

TEST(TickGate, ANewPaceCountsFromTheTickBefore) {
  TickGate gate(kPeriod_s, 1);
  gate.Opens(kStart);
  gate.OnTick(kStart + 10ms);
  gate.SetPace(0.25);
  EXPECT_EQ(gate.Opens(kStart + 12ms), kStart + 50ms);
  gate.SetPace(10);
  EXPECT_EQ(gate.Opens(kStart + 13ms), kStart + 11ms) << "it is due";
  gate.SetPace(0);
  EXPECT_TRUE(gate.IsOpen());
  gate.SetPace(1);
  EXPECT_EQ(gate.Opens(kStart + 20ms), kStart + 30ms);
}

TEST(TickGate, APauseHasNoEndUntilSomebodyAsks) {
  TickGate gate(kPeriod_s, 1);
  gate.Opens(kStart);
  gate.Pause();
  EXPECT_EQ(gate.Opens(kStart + 1h), std::nullopt);
  gate.Resume();
  EXPECT_EQ(gate.Opens(kStart + 2h), kStart + 2h + 10ms) << "the time of the pause is not made up for";
}

TEST(TickGate, StepsPassAtOnceAndEndInAPause) {
  TickGate gate(kPeriod_s, 1);
  gate.Opens(kStart);
  gate.Step(2);
  EXPECT_TRUE(gate.paused());
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(gate.Opens(kStart + 1ms), kStart + 1ms) << k;
    gate.OnTick(kStart + 1ms);
  }
  EXPECT_EQ(gate.Opens(kStart + 1ms), std::nullopt);
  gate.Step(1);
  gate.Pause();
  EXPECT_EQ(gate.Opens(kStart + 1ms), std::nullopt) << "a pause takes back the steps that are left";
}

TEST(TickGate, APaceThatIsSetInAPauseHoldsAfterIt) {
  TickGate gate(kPeriod_s, 1);
  gate.Pause();
  gate.SetPace(0);
  EXPECT_FALSE(gate.IsOpen());
  EXPECT_EQ(gate.Opens(kStart), std::nullopt);
  gate.Resume();
  EXPECT_TRUE(gate.IsOpen());
}

}  // namespace
}  // namespace mascot
