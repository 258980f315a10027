// Coverage of a region: its geometry, its closed forms on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "agent/laws/polygon.h"
#include "tests/ideal_network.h"
#include "tests/law_run.h"

namespace mascot {
namespace {

const Polygon kSquare = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};

TEST(Polygons, MomentsOfASquareAreThoseOfTheTextbook) {
  const Moments about_corner = MomentsOf(kSquare, {0, 0}, {});
  EXPECT_DOUBLE_EQ(about_corner.mass, 4);
  EXPECT_NEAR((about_corner.first - Eigen::Vector2d(4, 4)).norm(), 0, 1e-12);
  EXPECT_NEAR(about_corner.second, 2 * 16. / 3, 1e-12) << "2 * a^4 / 3";
  EXPECT_NEAR(MomentsOf(kSquare, {1, 1}, {}).second, 16. / 6, 1e-12) << "a^4 / 6 about the centre";
}

TEST(Polygons, QuadratureOfBumpsComesCloseToTheErrorFunction) {
  const std::vector<Bump> bumps = {{.centre_m = {0.8, 1.1}, .width_m = 1, .weight = 3}};
  const auto one = [](double from, double to) {  // the integral of exp(-x^2 / 2)
    return std::sqrt(std::acos(-1.0) / 2) * (std::erf(to / std::sqrt(2.0)) - std::erf(from / std::sqrt(2.0)));
  };
  const double mass = 3 * one(-0.8, 1.2) * one(-1.1, 0.9);
  EXPECT_NEAR(MomentsOf(kSquare, {0, 0}, bumps).mass, mass, 1e-4 * mass);
}

TEST(Polygons, CellsOfRandomPointsPartitionTheRegion) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(0, 2);
  for (int round = 0; round < 50; ++round) {
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 6; ++i) {
      const double x = anywhere(random), y = anywhere(random);
      points.emplace_back(x, y);
    }
    double area = 0;
    for (const Eigen::Vector2d& p : points) {
      Polygon cell = kSquare;
      for (const Eigen::Vector2d& other : points) cell = Nearer(cell, p, other);
      EXPECT_TRUE(IsConvex(cell));
      area += MomentsOf(cell, p, {}).mass;
    }
    EXPECT_NEAR(area, 4, 1e-12);
  }
}

TEST(Polygons, AreConvexOrNot) {
  EXPECT_TRUE(IsConvex(kSquare));
  EXPECT_FALSE(IsConvex({{0, 0}, {0, 2}, {2, 2}, {2, 0}})) << "clockwise";
  EXPECT_FALSE(IsConvex({{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}})) << "a dent";
  EXPECT_FALSE(IsConvex({{0, 0}, {2, 2}, {2, 0}, {0, 2}})) << "crosses itself";
  EXPECT_FALSE(IsConvex({{0, 0}, {2, 0}}));
  EXPECT_FALSE(IsConvex({{0, 0}, {1, 0}, {2, 0}})) << "no area";
}

/// Agents on the strip [0, 1] x [0, 0.002], at these x.
std::string Strip(const std::vector<double>& x, double duration_s, const std::string& more = "") {
  std::string positions;
  for (const double one : x) positions += (positions.empty() ? "[" : ", [") + ShortestFloat(one) + ", 0.001, 1]";
  return "[run]\nduration_s = " + ShortestFloat(duration_s) +
         "\n[physics]\ncollisions = false\n[agents]\nmodel = 'single_integrator'\ncount = " + std::to_string(x.size()) +
         "\nposition_m = [" + positions + "]\n[control]\nrate_hz = 20\n[law]\nname = 'coverage'\n" +
         "region_m = [[0, 0], [1, 0], [1, 0.002], [0, 0.002]]\ngain = 5.0\n" + more;
}

TEST(Coverage, OnAStripAgentsEndAtTheMiddlesOfEqualParts) {
  for (const std::vector<double>& start : {std::vector<double>{0.1, 0.2, 0.3}, {0.9, 0.91, 0.92, 0.93}, {0.4}}) {
    const auto n = static_cast<double>(start.size());
    const LawRun run(Strip(start, 30));
    EXPECT_NEAR(run.Measured("cost_end_m2"), 1 / (12 * n * n) + 0.002 * 0.002 / 12, 1e-9) << n << ": 1 / (12 n^2)";
    EXPECT_LE(run.Measured("largest_increase_m2"), run.Predicted("largest_increase_m2")) << n;
    EXPECT_LT(run.Predicted("largest_increase_m2"), 1e-11) << n;
    EXPECT_DOUBLE_EQ(run.Measured("cost_start_m2"), run.Predicted("cost_start_m2"));
    IdealNetwork network(Strip(start, 30));
    network.RunUntil(30);
    for (int i = 1; i <= network.experiment.size(); ++i)
      EXPECT_NEAR(network.agent(i).p_WB.x(), (2 * i - 1) / (2 * n), 1e-6) << "(2 i - 1) / (2 n)";
  }
}

/// Four agents in a corner of a square of 4 m.
std::string Corner(const std::string& law, const std::string& more = "",
                   const std::string& model = "single_integrator") {
  return "[run]\nduration_s = 15\n[physics]\ncollisions = false\n[agents]\nmodel = '" + model +
         "'\ncount = 4\nposition_m = [[0.3, 0.4, 1], [1.0, 0.3, 1], [0.4, 1.2, 1], [1.1, 1.3, 1]]\n" + more +
         "[law]\nname = 'coverage'\nregion_m = [[0, 0], [4, 0], [4, 4], [0, 4]]\n" + law;
}

TEST(Coverage, FourAgentsQuarterASquare) {
  const LawRun run(Corner(""));
  EXPECT_NEAR(run.Measured("cost_end_m2"), 2. / 3, 1e-3) << "squares of 2 m: 2 * 2^2 / 12";
  EXPECT_EQ(run.Law()["bounds"]["cost_end_m2"], "at_most");
  EXPECT_LT(run.Measured("cost_end_m2"), run.Predicted("cost_end_m2") / 2);
  EXPECT_LE(run.Measured("largest_increase_m2"), run.Predicted("largest_increase_m2"));
}

TEST(Coverage, WithoutADensityOneAgentEndsAtTheCentroidOfItsRegion) {
  const LawRun run(
      "[run]\nduration_s = 15\n[agents]\nmodel = 'single_integrator'\ncount = 1\nposition_m = [[5, 0.5, 1]]\n"
      "[law]\nname = 'coverage'\nregion_m = [[0, 0], [6, 0], [0, 3]]\ndensity = []\n");
  EXPECT_LT((run.meter.aim().value_m.head<2>() - Eigen::Vector2d(2, 1)).norm(), 1e-4);
  EXPECT_NEAR(run.Measured("cost_end_m2"), (36 + 9 + 45) / 36., 1e-6) << "of a triangle: the sides' squares over 36";
  EXPECT_LE(run.Measured("largest_increase_m2"), run.Predicted("largest_increase_m2"));
}

TEST(Coverage, TheCostFallsAlsoWhenAHeldCommandFliesPastTheCentroid) {
  const LawRun fast(Corner("gain = 190\n"));
  EXPECT_LE(fast.Measured("largest_increase_m2"), fast.Predicted("largest_increase_m2")) << "gain T = 1.9";
  EXPECT_EQ(LawRun(Corner("gain = 201\n")).prediction.silent, "law.gain is more than 2 per control period");
}

TEST(Coverage, ABumpDrawsAgentsToIt) {
  IdealNetwork network(Corner("density = [[3, 3, 0.5, 1]]\n"));
  network.RunUntil(15);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int id = 1; id <= 4; ++id) mean += network.agent(id).p_WB.head<2>() / 4;
  EXPECT_LT((mean - Eigen::Vector2d(3, 3)).norm(), 0.3);
  const LawRun run(Corner("density = [[3, 3, 0.5, 1]]\n"));
  EXPECT_LT(run.Measured("cost_end_m2"), run.Measured("cost_start_m2") / 5);
  EXPECT_TRUE(run.Law()["predicted"]["largest_increase_m2"].is_null()) << "sums over points are not exact";
}

TEST(Coverage, TheoryIsSilentAboutAgentsThatDoNotHearAll) {
  EXPECT_EQ(LawRun(Corner("", "[graph]\ntopology = 'path'\n")).prediction.silent,
            "agents that do not hear all others do not know what is nearer to them");
}

TEST(Coverage, DoubleIntegratorsAndQuadrotorsCoverTheSquareToo) {
  for (const std::string model : {"double_integrator", "quadrotor"}) {
    const LawRun run(Corner("gain = 0.5\n", "", model));
    EXPECT_NEAR(run.Measured("cost_end_m2"), 2. / 3, 0.05) << model;
  }
}

}  // namespace
}  // namespace mascot
