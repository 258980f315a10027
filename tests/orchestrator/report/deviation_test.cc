#include "orchestrator/report/deviation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/laws/laws.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

const std::string kThree =
    "[run]\nduration_s = 10.0\n[agents]\ncount = 3\nposition_m = [[0, 0, 1], [4, 0, 2], [0, 3, 3]]\n"
    "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1.0, 1.5]\n";

/// Three agents with these x (m); y = 0, z = 1, 2, 3.
std::vector<Motion> At(double first, double second, double third) {
  std::vector<Motion> motions(3);
  motions[0].p_WB = {first, 0, 1};
  motions[1].p_WB = {second, 0, 2};
  motions[2].p_WB = {third, 0, 3};
  return motions;
}

TEST(Pursuit, EndsWhenAChildIsCloseToItsParentForGood) {
  const Experiment experiment = Load(kThree);
  PursuitMeter meter(experiment);
  meter.Add(At(0, 4, 5));
  meter.Add(At(0, 0.04, 3));  // close, but not for good
  meter.Add(At(0, -0.06, 2));
  meter.Add(At(0, 0.05, 1));
  meter.Add(At(0, 0.01, 0.1));
  const auto edges = meter.Result();
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_EQ(edges[0].child, 2);
  EXPECT_EQ(edges[0].parent, 1);
  EXPECT_EQ(edges[0].time_s, 0.03);
  EXPECT_EQ(edges[1].child, 3);
  EXPECT_FALSE(edges[1].time_s) << "not yet";
  EXPECT_DOUBLE_EQ(edges[1].end_m, 0.09);
  meter.Add(At(0, 0, 0));
  EXPECT_EQ(meter.Result()[1].time_s, 0.05);
}

TEST(Pursuit, LooksAlongTheAxesOfTheLawAlone) {
  const Experiment experiment = Load(kThree + "axes = 'xyz'\n");
  PursuitMeter meter(experiment);
  meter.Add(At(0, 0, 0));
  EXPECT_FALSE(meter.Result()[0].time_s) << "a metre above";
}

TEST(Pursuit, HasNoEdgesInConsensus) {
  EXPECT_TRUE(PursuitMeter(Load("[run]\nduration_s = 1.0\n[agents]\ncount = 2\n")).Result().empty());
}

TEST(Deviation, IsMeasuredMinusPredictedAndADistanceAlongTheAxes) {
  const Experiment experiment = Load(kThree);
  Aim measured;
  measured.rows = 1;
  measured.value_m = {3, 4, 100};
  measured.settling_time_s = 5;
  measured.rate_per_s = 0.2;
  measured.minmax_edges = {{2, 1, 3.0}, {3, 2, 4.0}};
  Prediction prediction;
  prediction.value_m = Eigen::Vector3d(0, 0, 2);
  prediction.settling_time_s = 6;
  prediction.rate_per_s = 0.25;
  prediction.minmax_edges = {{2, 1, 3.5, true}};
  prediction.minmax_time_s = 3.5;
  const Deviation deviation = Compare(experiment, measured, prediction);
  EXPECT_EQ(deviation.value_m, 5.0);
  EXPECT_EQ(deviation.settling_time_s, -1.0);
  EXPECT_NEAR(*deviation.rate_per_s, -0.05, 1e-15);
  EXPECT_EQ(deviation.minmax_time_s, -0.5) << "of the edge that theory knows";
}

TEST(Deviation, IsAbsentWhereEitherValueIsAbsent) {
  const Experiment experiment = Load(kThree);
  Aim measured;
  measured.rows = 1;
  measured.minmax_edges = {{2, 1, std::nullopt}};
  measured.settling_time_s = 5;
  Prediction prediction;
  prediction.minmax_edges = {{2, 1, 3.5, true}};
  prediction.minmax_time_s = 3.5;
  const Deviation deviation = Compare(experiment, measured, prediction);
  EXPECT_FALSE(deviation.value_m);
  EXPECT_FALSE(deviation.settling_time_s);
  EXPECT_FALSE(deviation.rate_per_s);
  EXPECT_FALSE(deviation.minmax_time_s);
}

TEST(Deviation, OfSettlingIsAbsentForFlightsToWaypoints) {
  const Experiment experiment = Load(kThree);
  Aim measured;
  measured.settling_time_s = 5;
  Prediction prediction;
  prediction.settling_time_s = 6;
  prediction.of_agreement = false;
  EXPECT_FALSE(Compare(experiment, measured, prediction).settling_time_s);
}

}  // namespace
}  // namespace mascot
