// The response that theory predicts: disagreement over time, phase by phase, up to the first event.
#include "orchestrator/theory/response.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "orchestrator/theory/theory.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

std::vector<PartResponse> ResponsesIn(const std::string& toml) {
  const Experiment experiment = Load(toml);
  return ResponsesOf(experiment, Predict(experiment));
}

/// Two single integrators, 2 m from each other, that come nearer by a factor of 1 - 2 h p in each tick.
constexpr double kFactor = 1 - 2 * 0.01 * 0.5;
std::string TwoPoints(const std::string& more) {
  return "[run]\nduration_s = 8.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\n"
         "position_m = [[-1, 0, 1], [1, 0, 1]]\n[graph]\ntopology = 'ring'\n"
         "[law]\nname = 'velocity_consensus'\np_gain = 0.5\n" +
         more;
}

TEST(Response, OfTwoPointsDecaysByTheSameFactorInEachTick) {
  const std::vector<PartResponse> responses = ResponsesIn(TwoPoints(""));
  ASSERT_EQ(responses.size(), 1U);
  const auto& [from, until, response, of_ideal_bodies] = responses.front();
  EXPECT_EQ(from, 0);
  EXPECT_EQ(until, 800);
  EXPECT_FALSE(of_ideal_bodies);
  ASSERT_EQ(response.value_m.size(), 801U);
  for (std::size_t k = 0; k < response.value_m.size(); ++k)
    EXPECT_NEAR(response.value_m[k], std::pow(kFactor, static_cast<double>(k)), 1e-12) << k;
}

TEST(Response, BeginsAnewWithEachPhase) {
  const std::vector<PartResponse> responses = ResponsesIn(TwoPoints("[[law.schedule]]\nat_s = 3.0\np_gain = 1.0\n"));
  ASSERT_EQ(responses.size(), 2U);
  EXPECT_EQ(responses[0].until, 300);
  EXPECT_EQ(responses[1].from, 300);
  EXPECT_EQ(responses[1].until, 800);
  const double at_300_m = std::pow(kFactor, 300);
  EXPECT_NEAR(responses[0].response.value_m.at(300), at_300_m, 1e-12);
  for (std::size_t k = 0; k < responses[1].response.value_m.size(); ++k)
    EXPECT_NEAR(responses[1].response.value_m[k], at_300_m * std::pow(0.98, static_cast<double>(k)), 1e-12) << k;
}

TEST(Response, EndsWithTheFirstEvent) {
  const std::vector<PartResponse> whole = ResponsesIn(TwoPoints(""));
  const std::vector<PartResponse> responses =
      ResponsesIn(TwoPoints("[[events]]\nat_s = 2.0\nset = {law.p_gain = 1.0}\n"));
  ASSERT_EQ(responses.size(), 1U);
  EXPECT_EQ(responses[0].until, 200);
  ASSERT_GE(responses[0].response.value_m.size(), 200U);
  for (std::size_t k = 0; k < 200; ++k) EXPECT_EQ(responses[0].response.value_m[k], whole[0].response.value_m[k]) << k;
  EXPECT_TRUE(ResponsesIn(TwoPoints("[[events]]\nat_s = 0.0\nset = {law.p_gain = 1.0}\n")).empty());
}

TEST(Response, OfAgentsWhoFollowAFlyingLeaderIsThatOfIdealBodies) {
  // The leader flies 1 m away and oscillates: p'' = -(p - 1). Its follower is at first where the leader is.
  const std::vector<PartResponse> responses = ResponsesIn(
      "[run]\nduration_s = 3.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
      "position_m = [[0, 0, 1], [0, 0, 1]]\n[physics]\ncollisions = false\n[graph]\nedges = [[2, 1]]\n"
      "[law]\nname = 'consensus'\nleader = 1\np_gain = 1e-6\nbeta = 1.0\n"
      "leader_waypoints_m = [[1, 0, 1]]\nleader_p_gain = 1.0\nleader_d_gain = 0.0\n");
  ASSERT_EQ(responses.size(), 1U);
  EXPECT_TRUE(responses[0].of_ideal_bodies);
  ASSERT_EQ(responses[0].response.value_m.size(), 301U);
  for (std::size_t k = 0; k <= 300; k += 10)
    EXPECT_NEAR(responses[0].response.value_m[k], 1 - std::cos(0.01 * static_cast<double>(k)), 0.02) << k;
}

TEST(Response, IsUnknownWhereAgentsDoNotAgree) {
  EXPECT_TRUE(ResponsesIn("[run]\nduration_s = 3.0\n[agents]\ncount = 1\n[law]\nname = 'waypoint'\n"
                          "waypoints_m = [[1, 0, 1]]\n")
                  .empty());
  const auto at_1_hz = [](const char* p_gain) {  // the factor in each tick is 1 - 2 p_gain
    std::string toml = TwoPoints("[control]\nrate_hz = 1\n");
    return toml.replace(toml.find("p_gain = 0.5"), 12, p_gain);
  };
  EXPECT_EQ(ResponsesIn(at_1_hz("p_gain = 0.9")).size(), 1U);
  EXPECT_TRUE(ResponsesIn(at_1_hz("p_gain = 1.1")).empty()) << "unstable";
}

TEST(ResponseRecorder, KeepsEverySecondOrFourthValueOfALongFlight) {
  for (const std::int64_t ticks : {1, 1024, 1025, 5000}) {
    ResponseRecorder recorder;
    for (std::int64_t tick = 0; tick < ticks; ++tick) recorder.Add(static_cast<double>(tick));
    const Response response = recorder.Take();
    EXPECT_LE(response.value_m.size(), Response::kMaxPoints);
    EXPECT_GE(response.value_m.size(), std::min<std::size_t>(static_cast<std::size_t>(ticks), 512));
    for (std::size_t k = 0; k < response.value_m.size(); ++k)
      EXPECT_EQ(response.value_m[k], static_cast<double>(static_cast<std::int64_t>(k) * response.every)) << ticks;
    EXPECT_GT(response.value_m.back() + static_cast<double>(response.every), static_cast<double>(ticks - 1)) << ticks;
  }
}

}  // namespace
}  // namespace mascot
