// Coverage of a region: its geometry, its closed forms on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include "agent/laws/coverage/density.h"
#include "agent/laws/coverage/polygon.h"
#include "tests/support/ideal_network.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

const Polygon kSquare = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};

TEST(Polygons, MomentsOfASquareAreThoseOfTheTextbook) {
  const Moments about_corner = MomentsOf(kSquare, {0, 0});
  EXPECT_DOUBLE_EQ(about_corner.mass, 4);
  EXPECT_NEAR((about_corner.first - Eigen::Vector2d(4, 4)).norm(), 0, 1e-12);
  EXPECT_NEAR(about_corner.second, 2 * 16. / 3, 1e-12) << "2 * a^4 / 3";
  EXPECT_NEAR(MomentsOf(kSquare, {1, 1}).second, 16. / 6, 1e-12) << "a^4 / 6 about the centre";
}

/// The moments in units of 1, not of e^log_unit.
Moments InUnitsOfOne(Moments moments) {
  const double unit = std::exp(moments.log_unit);
  return {.mass = unit * moments.mass, .first = unit * moments.first, .second = unit * moments.second};
}

Moments PlainMomentsOf(const Polygon& polygon, const Eigen::Vector2d& o, const GaussianBump& bump) {
  return InUnitsOfOne(MomentsOf(polygon, o, std::span(&bump, 1)));
}

/// The largest difference between two moments, as a share of those of `b`.
double Difference(const Moments& a, const Moments& b) {
  const double first = (a.first - b.first).norm() / std::max(b.first.norm(), std::sqrt(b.mass * b.second));
  return std::max({std::abs(a.mass / b.mass - 1), first, std::abs(a.second / b.second - 1)});
}

TEST(Density, OfABumpInsideThePolygonTheMomentsAreThoseOfTheWholePlane) {
  for (const double s : {1e-6, 0.001, 0.05, 0.1}) {
    const GaussianBump bump{.centre_m = {0.8, 1.1}, .width_m = s, .weight = 3};
    const double mass = 3 * 2 * std::numbers::pi * s * s;
    const Moments about_centre = PlainMomentsOf(kSquare, bump.centre_m, bump);
    EXPECT_NEAR(about_centre.mass, mass, 1e-13 * mass) << s;
    EXPECT_LT(about_centre.first.norm(), 1e-13 * mass * s) << s;
    EXPECT_NEAR(about_centre.second, 2 * mass * s * s, 1e-13 * mass * s * s) << s;
    const Moments about_corner = PlainMomentsOf(kSquare, {0, 0}, bump);
    EXPECT_LT((about_corner.first / mass - bump.centre_m).norm(), 1e-13) << s;
    EXPECT_NEAR(about_corner.second / mass, 0.64 + 1.21 + 2 * s * s, 1e-13) << s;
  }
}

/// The integrals of x^k exp(-(x - c)^2 / (2 s^2)), k = 0, 1, 2, by the error function.
std::array<double, 3> OnALine(double from, double to, double c, double s) {
  const double a = (from - c) / (std::numbers::sqrt2 * s), b = (to - c) / (std::numbers::sqrt2 * s);
  const double erfs = a > 0   ? std::erfc(a) - std::erfc(b)
                      : b < 0 ? std::erfc(-b) - std::erfc(-a)
                              : std::erf(b) - std::erf(a);
  const double zero = s * std::sqrt(std::numbers::pi / 2) * erfs;
  const double e_a = std::exp(-a * a), e_b = std::exp(-b * b), one = s * s * (e_a - e_b);
  const double two = s * s * ((from - c) * e_a - (to - c) * e_b + zero);  // about c
  return {zero, one + c * zero, two + 2 * c * one + c * c * zero};
}

TEST(Density, OnARectangleTheMomentsAreProductsOfErrorFunctions) {
  const Polygon rectangle = {{-1, -0.5}, {3, -0.5}, {3, 1.5}, {-1, 1.5}};
  for (const double s : {0.05, 0.3, 1.0, 4.0})
    for (const Eigen::Vector2d& c :
         {Eigen::Vector2d(0.3, 0.2), Eigen::Vector2d(3, 1.5), Eigen::Vector2d(-1 - 6 * s, 0.1),
          Eigen::Vector2d(1, 1.5 + 20 * s), Eigen::Vector2d(3 + 3 * s, 1.5 + 2 * s)}) {
      const auto x = OnALine(-1, 3, c.x(), s), y = OnALine(-0.5, 1.5, c.y(), s);
      const Moments expected{
          .mass = x[0] * y[0], .first = {x[1] * y[0], x[0] * y[1]}, .second = x[2] * y[0] + x[0] * y[2]};
      EXPECT_LT(Difference(PlainMomentsOf(rectangle, {0, 0}, {c, s, 1}), expected), 1e-10)
          << s << " " << c.transpose() << "; the differences of error functions are less exact than what they test";
    }
}

TEST(Density, OfAVeryBroadBumpIsThatOfAUniformDensity) {
  const Polygon sliver = {{0, 0}, {9, 1}, {9, 1.00001}};
  for (const Polygon& polygon : {kSquare, sliver}) {
    const Moments broad = PlainMomentsOf(polygon, {1, 1}, {{0.3, -2}, 1e6, 1});
    EXPECT_LT(Difference(broad, MomentsOf(polygon, {1, 1})), 1e-9) << "1e-10 of it is the bend of the bump";
  }
}

TEST(Density, PartsOfAPolygonAddUpAndItMayBeShiftedAndTurned) {
  std::mt19937 random(3);
  const auto number = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const Polygon region = {{0, 0}, {4, -1}, {6, 1}, {6, 4}, {3, 6}, {0, 4}};
  for (int round = 0; round < 200; ++round) {
    const double x = number(-8, 14), y = number(-8, 14);
    const GaussianBump bump{.centre_m = {x, y}, .width_m = std::pow(10, number(-0.5, 2)), .weight = 2};
    const Eigen::Vector2d o(number(0, 6), number(0, 6)), through(number(1, 5), number(1, 4));
    const Eigen::Rotation2Dd turn(number(0, 6.28));
    const Eigen::Vector2d outward = turn * Eigen::Vector2d(1, 0), shift(number(-9, 9), number(-9, 9));
    const Moments all = PlainMomentsOf(region, o, bump);
    const Moments a = PlainMomentsOf(Within(region, through, outward), o, bump);
    const Moments b = PlainMomentsOf(Within(region, through, -outward), o, bump);
    const Moments sum{.mass = a.mass + b.mass, .first = a.first + b.first, .second = a.second + b.second};
    EXPECT_LT(Difference(sum, all), 1e-11) << round;
    Polygon moved;
    for (const Eigen::Vector2d& corner : region) moved.emplace_back(turn * corner + shift);
    Moments there = PlainMomentsOf(moved, turn * o + shift, {turn * bump.centre_m + shift, bump.width_m, bump.weight});
    there.first = turn.inverse() * there.first;
    EXPECT_LT(Difference(there, all), 1e-11) << round;
  }
}

TEST(Density, OfABumpFarAwayTheCentroidIsTheNearestPoint) {
  // At the distance d the density falls by e in s^2 / d, on an edge, and as fast along both edges of a corner.
  for (const double s : {1e-5, 0.001, 0.02}) {
    const Moments edge = MomentsOf(kSquare, {1.2, 2}, std::vector{GaussianBump{{1.2, 9}, s, 1}});
    EXPECT_NEAR(edge.first.x() / edge.mass, 0, 1e-9 * s) << s;
    EXPECT_NEAR(edge.first.y() / edge.mass, -s * s / 7, 1e-3 * s * s) << s;
    EXPECT_NEAR(edge.log_unit, -49 / (2 * s * s), 1e-12 * 49 / (s * s)) << s << ": too small a number without a unit";
    const Moments corner = MomentsOf(kSquare, {2, 2}, std::vector{GaussianBump{{5, 6}, s, 1}});
    EXPECT_NEAR(corner.first.x() / corner.mass, -s * s / 3, 1e-3 * s * s) << s;
    EXPECT_NEAR(corner.first.y() / corner.mass, -s * s / 4, 1e-3 * s * s) << s;
  }
}

TEST(Density, OfSeveralBumpsIsTheirSum) {
  const std::vector<GaussianBump> bumps = {{{0.5, 0.5}, 0.3, 1}, {{1.5, 1}, 0.5, 2}, {{9, 1}, 0.02, 7}};
  Moments sum;
  for (const GaussianBump& bump : bumps) {
    const Moments one = PlainMomentsOf(kSquare, {1, 0}, bump);
    sum.mass += one.mass;
    sum.first += one.first;
    sum.second += one.second;
  }
  EXPECT_LT(Difference(InUnitsOfOne(MomentsOf(kSquare, {1, 0}, bumps)), sum), 1e-13);
  EXPECT_EQ(MomentsOf({}, {1, 0}, bumps).mass, 0) << "no corners";
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
      area += MomentsOf(cell, p).mass;
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
    EXPECT_LT(run.Predicted("largest_increase_m2"), 1e-10) << n << ": rounding";
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
  EXPECT_LE(run.Measured("largest_increase_m2"), run.Predicted("largest_increase_m2"));
  EXPECT_LT(run.Predicted("largest_increase_m2"), 1e-9) << "the integrals are exact but for rounding";
}

TEST(Coverage, WithBumpsOfAnyWidthTheCostFallsAtEveryTick) {
  for (const char* density :
       {"[[3, 3, 0.02, 1]]", "[[3, 3, 0.001, 1], [0.5, 3, 0.3, 2]]", "[[2, 2, 50, 1]]", "[[6, 1, 0.1, 5]]"}) {
    const LawRun run(Corner("density = " + std::string(density) + "\n"));
    EXPECT_LE(run.Measured("largest_increase_m2"), run.Predicted("largest_increase_m2")) << density;
    EXPECT_LT(run.Measured("cost_end_m2"), run.Measured("cost_start_m2") / 2) << density;
    EXPECT_DOUBLE_EQ(run.Measured("cost_start_m2"), run.Predicted("cost_start_m2")) << density;
  }
}

TEST(Coverage, OneAgentEndsAtTheCentreOfANarrowBump) {
  IdealNetwork network(
      "[run]\nduration_s = 15\n[agents]\nmodel = 'single_integrator'\ncount = 1\nposition_m = [[5, 0.5, 1]]\n"
      "[law]\nname = 'coverage'\nregion_m = [[0, 0], [6, 0], [0, 3]]\ndensity = [[1.3, 0.7, 0.001, 1]]\ngain = 2.0\n");
  network.RunUntil(15);
  EXPECT_LT((network.agent(1).p_WB.head<2>() - Eigen::Vector2d(1.3, 0.7)).norm(), 1e-9);
}

TEST(Coverage, OfANarrowBumpBetweenFourAgentsTheCostIsTheIntegral) {
  const std::string team =
      "[run]\nduration_s = 1\n[agents]\nmodel = 'single_integrator'\ncount = 4\n"
      "position_m = [[-2, -1, 5], [1, 1, 6], [3, -2, 7], [-3, 2, 8]]\n[law]\nname = 'coverage'\n"
      "region_m = [[-5, -4], [5, -4], [5, 4], [-5, 4]]\n";
  // By sums over a grid of 0.001 m.
  EXPECT_NEAR(LawRun(team + "density = [[1.3, 0.7, 0.5, 1.0]]\n").Predicted("cost_start_m2"), 0.677, 0.0005);
  const double s = 0.02;
  EXPECT_NEAR(LawRun(team + "density = [[1.3, 0.7, 0.02, 1.0]]\n").Predicted("cost_start_m2"), 0.18 + 2 * s * s, 1e-12)
      << "|c - p_2|^2 + 2 s^2";
}

TEST(Coverage, AgentsThatStartAtOnePlaceCountOnceAndAreWarnedOf) {
  const auto strip = [](const std::string& x) {
    return "[run]\nduration_s = 1\n[physics]\ncollisions = false\n[agents]\nmodel = 'single_integrator'\ncount = 2\n"
           "position_m = [[0.5, 0.001, 1], [" +
           x +
           ", 0.001, 2]]\n[law]\nname = 'coverage'\n"
           "region_m = [[0, 0], [1, 0], [1, 0.002], [0, 0.002]]\n";
  };
  const LawRun run(strip("0.5"));
  EXPECT_NEAR(run.Measured("cost_start_m2"), 1 / 12. + 0.002 * 0.002 / 12, 1e-12);
  EXPECT_THAT(
      run.prediction.warnings,
      testing::Contains("agents.position_m: agents 1 and 2 start at one place in x and y, have one cell, and never "
                        "part"));
  EXPECT_THAT(LawRun(strip("0.6")).prediction.warnings,
              testing::Not(testing::Contains(testing::HasSubstr("one cell"))));
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
