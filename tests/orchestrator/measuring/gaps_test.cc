// How far agents with vehicles are from ideal bodies, by phase of their flights.
#include <gtest/gtest.h>

#include <cmath>

#include "orchestrator/measuring/metrics.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

const std::string kTeam =
    "[run]\nmode = 'realtime'\nduration_s = 10.0\n[agents]\ncount = 2\nposition_m = [[0.0, 0.0, 1.0], [5.0, 0.0, "
    "1.0]]\n"
    "[graph]\nadjacency = [[0.0, 0.0], [0.0, 0.0]]\n[law]\nname = 'consensus'\n";
const std::string kVehicle = "[[vehicles]]\nagents = [1]\nkind = 'px4'\n";

/// A row in which the first agent is so far from where it starts, and the other one stays there.
DecodedRow RowAt(const Experiment& experiment, double away_m) {
  DecodedRow row(2);
  for (std::size_t i = 0; i < 2; ++i) row.motions[i].p_WB = experiment.agents[i].p_W;
  row.motions[0].p_WB.x() += away_m;
  return row;
}

TEST(Gaps, AreOfVehiclesByPhase) {
  const Experiment experiment = Load(kTeam + kVehicle);
  Metrics metrics(experiment);
  metrics.OnVehicle({.agent = 1, .phase = FlightPhase::kReady});
  metrics.Add(RowAt(experiment, 0.1));
  metrics.OnVehicle({.agent = 1, .phase = FlightPhase::kFlying});
  metrics.Add(RowAt(experiment, 0.3));
  metrics.Add(RowAt(experiment, -0.4));
  const std::vector<Measured::Gap> gaps = metrics.Result().gaps;
  ASSERT_EQ(gaps.size(), 2U);
  EXPECT_EQ(gaps[0].phase, FlightPhase::kReady);
  EXPECT_EQ(gaps[0].rows, 1);
  EXPECT_NEAR(gaps[0].from_ideal.rms_m, 0.1, 1e-12);
  EXPECT_EQ(gaps[1].agent, 1);
  EXPECT_EQ(gaps[1].phase, FlightPhase::kFlying);
  EXPECT_EQ(gaps[1].rows, 2);
  EXPECT_NEAR(gaps[1].from_ideal.rms_m, std::sqrt((0.09 + 0.16) / 2), 1e-12);
  EXPECT_NEAR(gaps[1].from_ideal.max_m, 0.4, 1e-12);
}

TEST(Gaps, AreAbsentWithoutVehiclesOrIdealBodies) {
  const Experiment simulated = Load(kTeam);
  Metrics without(simulated);
  without.Add(RowAt(simulated, 0.1));
  EXPECT_TRUE(without.Result().gaps.empty());
  const Experiment unlike = Load(kTeam + kVehicle + "[output]\nfidelity = false\n");
  Metrics metrics(unlike);
  metrics.OnVehicle({.agent = 1, .phase = FlightPhase::kFlying});
  metrics.Add(RowAt(unlike, 0.1));
  EXPECT_TRUE(metrics.Result().gaps.empty());
}

}  // namespace
}  // namespace mascot
