// Flocking: what two agents do to each other, the closed forms of the whole flock, on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "agent/laws/flocking/sigma_norm.h"
#include "tests/support/folders.h"
#include "tests/support/ideal_network.h"
#include "tests/support/law_run.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

// --- two agents -------------------------------------------------------------------------------------------

const AlphaPair kPair(2, 3, 0.1, 0.3);

TEST(AlphaPairs, RepelBelowTheDistanceAttractAboveItAndEndAtTheRange) {
  EXPECT_LT(kPair.Stiffness(1.99), 0);
  EXPECT_NEAR(kPair.Stiffness(2), 0, 1e-15);
  EXPECT_GT(kPair.Stiffness(2.01), 0);
  EXPECT_NEAR(kPair.Stiffness(3 - 1e-6), 0, 1e-10) << "it fades";
  for (const double l : {3.0, 3.1, 100.0}) {
    EXPECT_EQ(kPair.Stiffness(l), 0) << l;
    EXPECT_EQ(kPair.Weight(l), 0) << l;
    EXPECT_EQ(kPair.Potential(l), kPair.Potential(3)) << l;
  }
  EXPECT_EQ(kPair.Weight(0), 1);
}

TEST(AlphaPairs, PullIsTheGradientOfThePotentialWhichIsLeastAtTheDistance) {
  for (int n = 1; n < 40; ++n) {
    const double l = 0.1 * n, step = 1e-5;
    const double slope = (kPair.Potential(l + step) - kPair.Potential(l - step)) / (2 * step);
    EXPECT_NEAR(slope, kPair.Stiffness(l) * l, 1e-9) << l;
    EXPECT_GE(kPair.Potential(l), 0) << l;
    EXPECT_LE(std::abs(kPair.Stiffness(l)), kPair.LargestCurvature()) << l;
  }
  EXPECT_NEAR(kPair.Potential(2), 0, 1e-15);
}

TEST(AlphaPairs, TheSmoothNormKeepsItsDigitsHoweverSmallEpsilonIs) {
  for (const double l : {1e-3, 0.1, 2.0})
    for (const double epsilon : {1e-12, 1e-9, 1e-6}) {
      const double e = epsilon * l * l;
      EXPECT_NEAR(SigmaNorm(l, epsilon) / (l * l / 2 * (1 - e / 4 + e * e / 8)), 1, 4e-16) << l << " " << epsilon;
    }
}

TEST(AlphaPairs, PotentialIsTheClosedFormWhereNothingFades) {
  const AlphaPair pair(2, 3, 0.1, 0.99);
  const double d = SigmaNorm(2, 0.1);
  for (const double l : {0.0, 0.7, 1.5, 2.5}) {
    const double off = SigmaNorm(l, 0.1) - d;
    EXPECT_NEAR(pair.Potential(l), std::sqrt(1 + off * off) - 1, 1e-12) << l;
  }
}

TEST(AlphaPairs, PotentialAndCurvatureAreRightHoweverSharpThePairIs) {
  // With a small epsilon and long distances phi is nearly a sign: it turns within 1 of s, which reaches to 5e7 here.
  for (const auto& [distance, range_m, epsilon, bump] : {std::array{2.0, 2.4, 0.1, 0.2},
                                                         {2.0, 3.0, 0.1, 0.95},
                                                         {100.0, 120.0, 1e-3, 0.2},
                                                         {5000.0, 1e4, 1e-6, 0.5},
                                                         {0.1, 5.0, 1000.0, 0.0},
                                                         {30.0, 2000.0, 0.5, 0.99}}) {
    const double distance_m = distance;  // which a lambda may capture
    const AlphaPair pair(distance_m, range_m, epsilon, bump);
    const double most = pair.LargestCurvature() * (1 + 1e-5);
    // The pull, summed up by Simpson's rule in steps that are short near the distance.
    const auto pull = [&pair](double l) { return pair.Stiffness(l) * l; };
    for (const double side : {-1.0, 1.0}) {
      const double end_m = side < 0 ? 0 : range_m * (1 - 1e-9), longest_m = std::abs(end_m - distance_m);
      const double shortest_m = 1e-9 * longest_m;
      double sum = 0, from_m = 0;
      for (int n = 0; n < 4000; ++n) {
        const double to_m = shortest_m * std::pow(longest_m / shortest_m, n / 3999.0);
        const auto at = [&](double beside_m) { return pull(distance_m + side * beside_m); };
        sum += (to_m - from_m) / 6 * (at(from_m) + 4 * at((from_m + to_m) / 2) + at(to_m));
        from_m = to_m;
      }
      EXPECT_NEAR(pair.Potential(end_m), side * sum, 1e-6 * std::abs(sum)) << distance_m << " " << side;
      for (int n = 0; n < 500; ++n) {
        const double beside_m = longest_m * std::pow(1e-5, n / 500.0) * 0.999;
        const double l = distance_m + side * beside_m, step = 1e-4 * beside_m;
        const double curvature = (pull(l + step) - pull(l - step)) / (2 * step);
        ASSERT_LE(std::abs(curvature), most) << distance_m << " at " << l;
      }
    }
  }
}

TEST(AlphaPairs, TheBoundOfTheCurvatureIsTight) {
  double largest = 0;
  for (int n = 1; n < 30000; ++n) {
    const double l = n * 1e-4, step = 1e-5;
    const double curvature =
        (kPair.Stiffness(l + step) * (l + step) - kPair.Stiffness(l - step) * (l - step)) / (2 * step);
    largest = std::max({largest, std::abs(curvature), std::abs(kPair.Stiffness(l))});
  }
  EXPECT_LT(kPair.LargestCurvature(), 1.03 * largest);
}

// --- flocks -----------------------------------------------------------------------------------------------

/// Nine agents that fly about, at 2 m from each other or so.
std::string Nine(const std::string& law, const std::string& more = "", const std::string& model = "double_integrator",
                 double duration_s = 10) {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) + "\n[agents]\nmodel = '" + model +
         "'\ncount = 9\nposition_m = [[-2.1, -1.8, 1], [0.2, -2.3, 1], [2.2, -1.9, 1], [-2.4, 0.3, 1], [0, 0.1, 1], "
         "[1.9, 0.2, 1], [-1.8, 2.2, 1], [0.3, 1.9, 1], [2.4, 2.3, 1]]\nvelocity_m_per_s = [[0.3, 0.2, 0], [-0.4, 0.1, "
         "0], [0, 0.5, 0], [0.6, -0.2, 0], [0.1, 0.1, 0], [-0.2, -0.4, 0], [0.3, -0.3, 0], [0.2, 0.4, 0], [0.5, 0, "
         "0]]\n" +
         more + "[law]\nname = 'flocking'\n" + law;
}

const std::string kMoving = "target_m = [1, -2, 1]\ntarget_velocity_m_per_s = [0.4, 0.3, 0]\n";

/// Mean position and velocity of a network.
Motion CentreOf(const IdealNetwork& network) {
  Motion centre;
  const auto count = static_cast<double>(network.motions.size());
  for (const Motion& motion : network.motions) {
    centre.p_WB += motion.p_WB / count;
    centre.v_WB += motion.v_WB / count;
  }
  return centre;
}

TEST(Flocking, TwoAgentsEndAtTheDistanceAndAtOneVelocity) {
  IdealNetwork network(
      "[run]\nduration_s = 1\n[agents]\nmodel = 'double_integrator'\ncount = 2\nposition_m = [[0, 0, 1], [1.6, 0.5, "
      "1]]\nvelocity_m_per_s = [[0.2, 0, 0], [0, 0.1, 0]]\n[law]\nname = 'flocking'\nrange_ratio = 2\nc1_gamma = "
      "0\nc2_gamma = 0\n");
  network.RunUntil(60);
  EXPECT_NEAR((network.agent(1).p_WB - network.agent(2).p_WB).norm(), 2, 1e-6);
  for (int id = 1; id <= 2; ++id)
    EXPECT_NEAR((network.agent(id).v_WB - Eigen::Vector3d(0.1, 0.05, 0)).norm(), 0, 1e-6) << "the mean of the start";
}

TEST(Flocking, TheCentreOfMassObeysTheLinearEquation) {
  IdealNetwork network(Nine(kMoving + "c1_gamma = 0.5\nc2_gamma = 0.6\n"));
  const Motion start = CentreOf(network);
  const Eigen::Vector3d q(1, -2, 0), v(0.4, 0.3, 0);
  const Eigen::Vector3d x = Along(Axes::kXy, start.p_WB) - q, y = start.v_WB - v;
  const double s = 0.3, w = std::sqrt(0.5 - s * s);  // roots -s +- j w
  while (network.time_s() < 10) {
    network.Step();
    const double t = network.time_s();
    const Eigen::Vector3d exact =
        std::exp(-s * t) * (std::cos(w * t) * x + std::sin(w * t) / w * (y + s * x)) + q + t * v;
    ASSERT_NEAR((Along(Axes::kXy, CentreOf(network).p_WB) - exact).norm(), 0, 1e-2) << t << ": up to the period";
  }
}

TEST(Flocking, WithoutAGammaAgentTheMeanVelocityStays) {
  IdealNetwork network(Nine("c1_gamma = 0\nc2_gamma = 0\n"));
  const Motion start = CentreOf(network);
  network.RunUntil(10);
  EXPECT_NEAR((CentreOf(network).v_WB - start.v_WB).norm(), 0, 1e-14);
}

TEST(Flocking, AgentsBeyondTheRangeDoNotMatter) {
  // In the path 1 - 2 - 3 each agent hears those next to it; in the complete graph agents 1 and 3, 3.8 m apart, hear
  // each other, too.
  const auto three = [](const std::string& graph) {
    return "[run]\nduration_s = 1\n[agents]\nmodel = 'double_integrator'\ncount = 3\nposition_m = [[0, 0, 1], [1.9, 0, "
           "1], [3.8, 0, 1]]\n[graph]\n" +
           graph + "[law]\nname = 'flocking'\nc1_gamma = 0\n";
  };
  IdealNetwork path(three("topology = 'path'\n")), all(three("topology = 'complete'\n"));
  for (int n = 0; n < 100; ++n) {
    path.Step();
    all.Step();
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(path.motions[i].p_WB, all.motions[i].p_WB) << n;
  }
  EXPECT_NE(all.motions[0].p_WB.x(), 0);
}

TEST(Flocking, IsPredictedAndMeasured) {
  for (const std::string& target : {std::string(), kMoving}) {
    const LawRun run(Nine(target, "", "double_integrator", 6));
    EXPECT_EQ(run.prediction.silent, "");
    for (const std::string figure : {"centre_rms_m", "centre_off_m", "centre_off_m_per_s"})
      EXPECT_NEAR(run.Measured(figure), run.Predicted(figure), 1e-9) << figure;
    EXPECT_GT(run.Measured("centre_rms_m"), 0.1);
    EXPECT_EQ(run.Law()["bounds"]["centre_rms_m"], "equal");
    EXPECT_EQ(run.Law()["bounds"]["energy_growth_share"], "at_most");
    EXPECT_LE(run.Measured("energy_growth_share"), run.Predicted("energy_growth_share"));
    EXPECT_LT(run.Predicted("energy_growth_share"), 1e-3);
    EXPECT_EQ(run.Measured("groups"), 1);
    EXPECT_GT(run.Measured("least_distance_m"), 1.5);
    EXPECT_LT(run.Measured("velocity_off_m_per_s"), 0.05);
  }
}

TEST(Flocking, TheBoundOfTheEnergyComesDownWithThePeriod) {
  double before = 1;
  for (const std::string rate : {"100", "200", "500"}) {
    const LawRun run(Nine(kMoving, "[control]\nrate_hz = " + rate + "\n", "double_integrator", 1));
    EXPECT_LE(run.Measured("energy_growth_share"), run.Predicted("energy_growth_share")) << rate;
    EXPECT_LT(run.Predicted("energy_growth_share"), before / 4) << rate;
    before = run.Predicted("energy_growth_share");
  }
  const LawRun slow(Nine("", "[control]\nrate_hz = 10\n", "double_integrator", 2));
  EXPECT_TRUE(slow.Law()["predicted"]["energy_growth_share"].is_null());
  EXPECT_FALSE(slow.Law()["predicted"]["centre_rms_m"].is_null());
}

TEST(Flocking, ABoundOfTheEnergyThatIsNoneIsNotTold) {
  for (const double duration_s : {1.0, 10.0}) {
    const LawRun run(Nine("c1_alpha = 2.0\nc2_alpha = 2.0\nc2_gamma = 20.0\n",
                          "[control]\nrate_hz = 40\nmax_acceleration_m_per_s2 = 1000.0\n", "double_integrator",
                          duration_s));
    EXPECT_EQ(run.Law()["predicted"]["energy_growth_share"].is_null(), duration_s > 1)
        << "each tick may add 3 %: after 10 s that is more than everything";
    EXPECT_FALSE(run.Law()["predicted"]["centre_rms_m"].is_null());
  }
}

TEST(Flocking, EnergyGrowsWithoutDamping) {
  const LawRun run(Nine("c2_alpha = 0\nc2_gamma = 0\nc1_alpha = 4\n", "", "double_integrator", 3));
  EXPECT_GT(run.Measured("energy_growth_share"), 0) << "the figure can see it: a held force adds energy";
  EXPECT_TRUE(run.Law()["predicted"]["energy_growth_share"].is_null());
}

TEST(Flocking, WithoutAGammaAgentAFlockFallsIntoGroups) {
  EXPECT_GT(LawRun(Nine("c1_gamma = 0\nc2_gamma = 0\n", "", "double_integrator", 5)).Measured("groups"), 1)
      << "Algorithm 1 of the paper";
}

TEST(Flocking, IsNotDisturbedByARangeOfHearingBeyondItsOwn) {
  const LawRun wide(Nine(kMoving, "[graph]\nrange_m = 2.4\n", "double_integrator", 2));
  EXPECT_EQ(wide.prediction.silent, "");
  EXPECT_NEAR(wide.Measured("centre_off_m"), wide.Predicted("centre_off_m"), 1e-9);
  EXPECT_TRUE(wide.Law()["predicted"]["energy_growth_share"].is_number());
  const LawRun narrow(Nine(kMoving, "[graph]\nrange_m = 2.3\n", "double_integrator", 1));
  EXPECT_EQ(narrow.Law()["reasons"]["energy_growth_share"],
            "graph.range_m is less than the 2.4 m that the law reaches");
  EXPECT_NEAR(narrow.Measured("centre_off_m"), narrow.Predicted("centre_off_m"), 1e-9)
      << "two hear each other, or neither does: the centre moves by itself";
}

TEST(Flocking, RangeOfHearingIsInSpaceAndTheLawInThePlane) {
  const auto at_heights = [](const std::string& range_m, const std::string& law = "") {
    return "[run]\nduration_s = 6\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = 5\nmodel = "
           "'double_integrator'\nposition_m = [[-1.6, -0.4, 6], [0.8, -2.8, 7], [2, 2, 8], [-2.5, 1, 9], [0.5, 0.5, "
           "10]]\n[graph]\nrange_m = " +
           range_m + "\n[law]\nname = 'flocking'\n" + law;
  };
  const LawRun cut(at_heights("2.6"));
  EXPECT_EQ(cut.Law()["reasons"]["energy_growth_share"],
            "graph.range_m is of distances in space: at heights 4 m apart it takes 4.665 m to hear all that the law "
            "reaches");
  EXPECT_NEAR(cut.Measured("centre_off_m"), cut.Predicted("centre_off_m"), 1e-9);
  const LawRun heard(at_heights("4.67"));
  EXPECT_LE(heard.Measured("energy_growth_share"), heard.Predicted("energy_growth_share"));
  const LawRun in_space(at_heights("2.6", "axes = 'xyz'\ntarget_m = [0, 0, 8]\n"));
  EXPECT_LE(in_space.Measured("energy_growth_share"), in_space.Predicted("energy_growth_share"));
}

TEST(Flocking, AnEventSendsTheFlockElsewhere) {
  const std::string event = "[[events]]\nat_s = 1.0\nset = { \"law.target_m\" = [-5, 4, 1], \"law.c1_gamma\" = 1.0 }\n";
  const LawRun run(Nine("", event));
  EXPECT_LT(run.Measured("centre_off_m"), 0.1) << "measured to the new target";
  EXPECT_GT(run.Measured("centre_rms_m"), 1);
  EXPECT_LT((Eigen::Vector2d(run.summary["consensus"]["value_m"][0], run.summary["consensus"]["value_m"][1]) -
             Eigen::Vector2d(-5, 4))
                .norm(),
            0.1);
  EXPECT_LT(run.Measured("energy_growth_share"), 1e-4) << "what the event added is no growth";
}

TEST(Flocking, TheoryIsSilentAboutDirectedGraphs) {
  EXPECT_EQ(LawRun(Nine("", "[graph]\ntopology = 'directed_ring'\n", "double_integrator", 1)).prediction.silent,
            "the closed forms are of undirected graphs");
}

TEST(Flocking, SingleIntegratorsAndQuadrotorsFlockToo) {
  for (const std::string model : {"single_integrator", "quadrotor"}) {
    const LawRun run(Nine(kMoving, "", model, 6));
    EXPECT_GT(run.Measured("order"), 0.99) << model;
    EXPECT_EQ(run.Measured("groups"), 1) << model;
    EXPECT_EQ(run.summary["safety"]["collisions"], 0) << model;
  }
}

TEST(Flocking, TwentyQuadrotorsReachOneVelocityWithoutAContact) {
  const LawRun run(ReadFile(test::SourceFolder() + "/configs/flocking.toml"));
  EXPECT_EQ(run.experiment.size(), 20);
  EXPECT_EQ(run.summary["safety"]["collisions"], 0);
  EXPECT_GT(run.Measured("least_distance_m"), 1.2);
  EXPECT_GT(run.Measured("order"), 0.999);
  EXPECT_LT(run.Measured("velocity_off_m_per_s"), 0.1);
  EXPECT_EQ(run.Measured("groups"), 1);
  EXPECT_NEAR(run.Measured("centre_rms_m"), run.Predicted("centre_rms_m"), 0.01 * run.Predicted("centre_rms_m"));
  EXPECT_LE(run.Measured("energy_growth_share"), run.Predicted("energy_growth_share"));
}

}  // namespace
}  // namespace mascot
