#include "orchestrator/theory/lagged_pursuit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "orchestrator/theory/minmax_time.h"
#include "orchestrator/theory/theory.h"
#include "tests/orchestrator/theory/flown_network.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

TEST(LaggedPursuit, TremblesByTheAmplitudeOfItsLimitCycle) {
  EXPECT_NEAR(TrembleRadius(1, 1, 0.1), 0.01 * std::pow(2 + std::sqrt(2), 2) / 2, 1e-12);
  for (const double r : {0.1, 0.4, 0.7, 1.0}) {
    const double beta = 1.5, lag_s = 0.2, radius_m = TrembleRadius(r * beta, beta, lag_s);
    EXPECT_TRUE(LaggedMinmaxTime(4, 0.3, r * beta, beta, lag_s, 1.1 * radius_m)) << r;
    EXPECT_FALSE(LaggedMinmaxTime(4, 0.3, r * beta, beta, lag_s, 0.9 * radius_m)) << r;
  }
}

TEST(LaggedPursuit, TakesTheTimeOfTheLawWithoutALagAsTheLagVanishes) {
  for (const double w : {-0.5, 0.0, 0.8}) {
    const double exact_s = MinmaxTime(3, w, 0.4, 1);
    EXPECT_NEAR(*LaggedMinmaxTime(3, w, 0.4, 1, 1e-3, 1e-5), exact_s, 0.02);
  }
  EXPECT_FALSE(LaggedMinmaxTime(1e6, 0, 1e-3, 1, 1e-3, 1)) << "too many steps";
}

/// A quadrotor that is to meet one that rests, with random bounds, distance and velocity.
std::string RandomPair(const std::string& airframe, int n) {
  Random random(static_cast<std::uint64_t>(n), Random::Stream::kSweep);
  const auto within = [&random](double least, double most) { return ShortestFloat(random.In(least, most)); };
  const double beta = random.In(0.2, 1.0), parent_beta = beta * random.In(0.1, 0.9);
  return "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = 2\nairframe = '" +
         airframe + "'\nposition_m = [[0, 0, 1], [" + within(-10, 10) + ", " + within(-10, 10) +
         ", 2]]\nvelocity_m_per_s = [[0, 0, 0], [" + within(-0.5, 0.5) + ", " + within(-0.5, 0.5) +
         ", 0]]\n[graph]\nedges = [[2, 1]]\n[law]\nname = 'minmax'\nleader = 1\nbeta = [" + ShortestFloat(parent_beta) +
         ", " + ShortestFloat(beta) + "]\n";
}

/// When a pair came within twice the predicted radius for good, minus the prediction (s); and how far apart it was at
/// most in the last 5 s, per axis, over the radius.
struct Outcome {
  double late_s = 0;
  double amplitude = 0;
};

Outcome FlyPursuit(const std::string& toml) {
  FlownNetwork pair(toml);
  const Trembling predicted = Predict(pair.experiment).minmax_edges.at(0).trembling.value();
  const double end_s = *predicted.time_s + 20;
  double last_outside_s = 0, apart_m = 0;
  while (pair.experiment.time_s(pair.world.tick()) < end_s) {
    pair.Step();
    const double now_s = pair.experiment.time_s(pair.world.tick());
    const double now_m = (pair.agent(2).p_WB - pair.agent(1).p_WB).head<2>().cwiseAbs().maxCoeff();
    if (now_m > 2 * predicted.radius_m) last_outside_s = now_s;
    if (now_s > end_s - 5) apart_m = std::max(apart_m, now_m);
  }
  return {last_outside_s - *predicted.time_s, apart_m / predicted.radius_m};
}

TEST(LaggedPursuit, SaysHowAHundredPairsOfQuadrotorsTrembleAndWhenTheyAreThere) {
  int late = 0;
  for (int n = 0; n < 100; ++n) {
    const std::string airframe(AirframeNames()[static_cast<std::size_t>(n) % AirframeNames().size()]);
    const Outcome outcome = FlyPursuit(RandomPair(airframe, n));
    EXPECT_THAT(outcome.amplitude, AllOf(Ge(0.5), Le(2))) << airframe << ", pair " << n;
    late += outcome.late_s > 0.5;
  }
  EXPECT_LE(late, 2);
}

}  // namespace
}  // namespace mascot
