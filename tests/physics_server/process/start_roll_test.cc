#include "physics_server/process/start_roll.h"

#include <gtest/gtest.h>

#include "tests/support/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using Next = StartRoll::Next;

constexpr bool kMatched = true, kReady = true;

/// A roll for three agents and a timeout of 60 s; it began at kT0 and has asked once.
StartRoll Begun() {
  StartRoll roll(3, 60.0);
  roll.Begin(kT0);
  EXPECT_EQ(roll.Look(kT0, kMatched), Next::kAsk);
  return roll;
}

/// A roll that has begun, with all agents and the recorder ready.
StartRoll Complete() {
  StartRoll roll = Begun();
  roll.OnAgents({1, 3}, kReady);
  roll.OnRecorder(kReady);
  return roll;
}

TEST(StartRoll, StartsWhenEveryAgentAndTheRecorderAreReady) {
  StartRoll roll = Begun();
  roll.OnAgents({2, 2}, kReady);
  roll.OnAgents({3, 3}, kReady);
  roll.OnRecorder(kReady);
  EXPECT_EQ(roll.Look(kT0 + 1ms, kMatched), Next::kWait);
  roll.OnAgents({1, 1}, kReady);
  EXPECT_EQ(roll.Look(kT0 + 2ms, kMatched), Next::kStart);
}

TEST(StartRoll, WaitsForTheRecorder) {
  StartRoll roll = Begun();
  roll.OnAgents({1, 3}, kReady);
  EXPECT_EQ(roll.Look(kT0 + 1ms, kMatched), Next::kWait);
  roll.OnRecorder(kReady);
  EXPECT_EQ(roll.Look(kT0 + 1ms, kMatched), Next::kStart);
}

TEST(StartRoll, WaitsForTheMatchingOfAllEndpoints) {
  StartRoll roll = Complete();
  EXPECT_EQ(roll.Look(kT0 + 1ms, !kMatched), Next::kWait);
  EXPECT_EQ(roll.Look(kT0 + 2ms, kMatched), Next::kStart);
}

TEST(StartRoll, CountsAgentsThatAreReadyBeforeItBegins) {
  StartRoll roll(1, 60.0);
  roll.OnAgents({1, 1}, kReady);
  roll.OnRecorder(kReady);
  roll.Begin(kT0);
  EXPECT_EQ(roll.Look(kT0, kMatched), Next::kStart);
}

TEST(StartRoll, IgnoresASecondReady) {
  StartRoll roll = Begun();
  for (int time = 0; time < 3; ++time) roll.OnAgents({1, 1}, kReady);
  roll.OnRecorder(kReady);
  roll.OnRecorder(kReady);
  EXPECT_EQ(roll.Look(kT0 + 1ms, kMatched), Next::kWait);
  EXPECT_EQ(roll.Failure(), "not ready within run.start_timeout_s = 60.0 s: agents 2, 3");
}

TEST(StartRoll, WaitsAgainForAProcessThatIsNoLongerReady) {
  StartRoll roll = Complete();
  roll.OnAgents({2, 2}, !kReady);
  EXPECT_EQ(roll.Look(kT0 + 1ms, kMatched), Next::kWait);
  roll.OnAgents({2, 2}, kReady);
  roll.OnRecorder(!kReady);
  EXPECT_EQ(roll.Look(kT0 + 2ms, kMatched), Next::kWait);
  roll.OnRecorder(kReady);
  EXPECT_EQ(roll.Look(kT0 + 3ms, kMatched), Next::kStart);
}

TEST(StartRoll, IgnoresUnknownAgents) {
  StartRoll roll = Begun();
  roll.OnRecorder(kReady);
  for (const AgentRange strangers : {AgentRange{4, 9}, {0, 0}, {-7, 0}, {3, 2}, {5, -5}})
    roll.OnAgents(strangers, kReady);
  EXPECT_EQ(roll.Failure(), "not ready within run.start_timeout_s = 60.0 s: agents 1, 2, 3");
  roll.OnAgents({-7, 99}, kReady);
  EXPECT_EQ(roll.Look(kT0 + 1ms, kMatched), Next::kStart);
}

TEST(StartRoll, AsksAgainFourTimesASecond) {
  StartRoll roll = Begun();
  EXPECT_EQ(roll.Look(kT0 + 249ms, kMatched), Next::kWait);
  EXPECT_EQ(roll.Look(kT0 + 250ms, kMatched), Next::kAsk);
  EXPECT_EQ(roll.Look(kT0 + 251ms, kMatched), Next::kWait);
  EXPECT_EQ(roll.Look(kT0 + 499ms, kMatched), Next::kWait);
  EXPECT_EQ(roll.Look(kT0 + 510ms, kMatched), Next::kAsk);
  EXPECT_EQ(roll.Look(kT0 + 759ms, kMatched), Next::kWait) << "from when it asked last";
}

TEST(StartRoll, FailsWhenItsTimeIsUp) {
  StartRoll roll = Begun();
  EXPECT_NE(roll.Look(kT0 + 60s - 1ns, kMatched), Next::kFail);
  EXPECT_EQ(roll.Look(kT0 + 60s, kMatched), Next::kFail);
}

TEST(StartRoll, StartsIfAllAreReadyAtTheLastMoment) {
  StartRoll roll = Complete();
  EXPECT_EQ(roll.Look(kT0 + 61s, kMatched), Next::kStart);
}

TEST(StartRoll, NamesTheProcessesThatAreMissing) {
  const std::string failure = "not ready within run.start_timeout_s = 60.0 s: ";
  StartRoll roll = Begun();
  EXPECT_EQ(roll.Failure(), failure + "agents 1, 2, 3 and the recorder");
  roll.OnAgents({1, 2}, kReady);
  EXPECT_EQ(roll.Failure(), failure + "agent 3 and the recorder");
  roll.OnAgents({3, 3}, kReady);
  EXPECT_EQ(roll.Failure(), failure + "the recorder");
  roll.OnRecorder(kReady);
  EXPECT_EQ(roll.Failure(), failure + "the wire (readers or writers that have not found each other)");
}

}  // namespace
}  // namespace mascot
