#include "physics_server/process/join_list.h"

#include <gtest/gtest.h>

#include "tests/support/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using Next = JoinList::Next;

constexpr bool kMatched = true, kReady = true;

/// A list for three agents and a timeout of 60 s; it began at kT0 and has asked once.
JoinList Begun() {
  JoinList list(3, 60.0);
  list.Begin(kT0);
  EXPECT_EQ(list.Look(kT0, kMatched), Next::kAsk);
  return list;
}

/// A list that has begun, with all agents and the recorder ready.
JoinList Complete() {
  JoinList list = Begun();
  list.OnAgents({1, 3}, kReady);
  list.OnRecorder(kReady);
  return list;
}

TEST(JoinList, StartsWhenEveryAgentAndTheRecorderAreReady) {
  JoinList list = Begun();
  list.OnAgents({2, 2}, kReady);
  list.OnAgents({3, 3}, kReady);
  list.OnRecorder(kReady);
  EXPECT_EQ(list.Look(kT0 + 1ms, kMatched), Next::kWait);
  list.OnAgents({1, 1}, kReady);
  EXPECT_EQ(list.Look(kT0 + 2ms, kMatched), Next::kStart);
}

TEST(JoinList, WaitsForTheRecorder) {
  JoinList list = Begun();
  list.OnAgents({1, 3}, kReady);
  EXPECT_EQ(list.Look(kT0 + 1ms, kMatched), Next::kWait);
  list.OnRecorder(kReady);
  EXPECT_EQ(list.Look(kT0 + 1ms, kMatched), Next::kStart);
}

TEST(JoinList, WaitsForTheMatchingOfAllEndpoints) {
  JoinList list = Complete();
  EXPECT_EQ(list.Look(kT0 + 1ms, !kMatched), Next::kWait);
  EXPECT_EQ(list.Look(kT0 + 2ms, kMatched), Next::kStart);
}

TEST(JoinList, CountsAgentsThatAreReadyBeforeItBegins) {
  JoinList list(1, 60.0);
  list.OnAgents({1, 1}, kReady);
  list.OnRecorder(kReady);
  list.Begin(kT0);
  EXPECT_EQ(list.Look(kT0, kMatched), Next::kStart);
}

TEST(JoinList, IgnoresASecondReady) {
  JoinList list = Begun();
  for (int time = 0; time < 3; ++time) list.OnAgents({1, 1}, kReady);
  list.OnRecorder(kReady);
  list.OnRecorder(kReady);
  EXPECT_EQ(list.Look(kT0 + 1ms, kMatched), Next::kWait);
  EXPECT_EQ(list.Failure(), "not ready within run.start_timeout_s = 60.0 s: agents 2-3");
}

TEST(JoinList, WaitsAgainForAProcessThatIsNoLongerReady) {
  JoinList list = Complete();
  list.OnAgents({2, 2}, !kReady);
  EXPECT_EQ(list.Look(kT0 + 1ms, kMatched), Next::kWait);
  list.OnAgents({2, 2}, kReady);
  list.OnRecorder(!kReady);
  EXPECT_EQ(list.Look(kT0 + 2ms, kMatched), Next::kWait);
  list.OnRecorder(kReady);
  EXPECT_EQ(list.Look(kT0 + 3ms, kMatched), Next::kStart);
}

TEST(JoinList, IgnoresUnknownAgents) {
  JoinList list = Begun();
  list.OnRecorder(kReady);
  for (const AgentRange strangers : {AgentRange{4, 9}, {0, 0}, {-7, 0}, {3, 2}, {5, -5}})
    list.OnAgents(strangers, kReady);
  EXPECT_EQ(list.Failure(), "not ready within run.start_timeout_s = 60.0 s: agents 1-3");
  list.OnAgents({-7, 99}, kReady);
  EXPECT_EQ(list.Look(kT0 + 1ms, kMatched), Next::kStart);
}

TEST(JoinList, AsksAgainTenTimesASecond) {
  JoinList list = Begun();
  EXPECT_EQ(list.Look(kT0 + 99ms, kMatched), Next::kWait);
  EXPECT_EQ(list.Look(kT0 + 100ms, kMatched), Next::kAsk);
  EXPECT_EQ(list.Look(kT0 + 101ms, kMatched), Next::kWait);
  EXPECT_EQ(list.Look(kT0 + 199ms, kMatched), Next::kWait);
  EXPECT_EQ(list.Look(kT0 + 210ms, kMatched), Next::kAsk);
  EXPECT_EQ(list.Look(kT0 + 309ms, kMatched), Next::kWait) << "from when it asked last";
}

TEST(JoinList, FailsWhenItsTimeIsUp) {
  JoinList list = Begun();
  EXPECT_NE(list.Look(kT0 + 60s - 1ns, kMatched), Next::kFail);
  EXPECT_EQ(list.Look(kT0 + 60s, kMatched), Next::kFail);
}

TEST(JoinList, StartsIfAllAreReadyAtTheLastMoment) {
  JoinList list = Complete();
  EXPECT_EQ(list.Look(kT0 + 61s, kMatched), Next::kStart);
}

TEST(JoinList, NamesTheProcessesThatAreMissing) {
  const std::string failure = "not ready within run.start_timeout_s = 60.0 s: ";
  JoinList list = Begun();
  EXPECT_EQ(list.Failure(), failure + "agents 1-3 and the recorder");
  list.OnAgents({1, 2}, kReady);
  EXPECT_EQ(list.Failure(), failure + "agent 3 and the recorder");
  list.OnAgents({3, 3}, kReady);
  EXPECT_EQ(list.Failure(), failure + "the recorder");
  list.OnRecorder(kReady);
  EXPECT_EQ(list.Failure(), failure + "the wire (readers or writers that have not found each other)");
}

}  // namespace
}  // namespace mascot
