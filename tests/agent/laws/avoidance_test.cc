// The law avoidance: its equation, the bound of the clearance, and flights past obstacles on all models.
#include <gmock/gmock.h>

#include <cmath>

#include "agent/laws/avoidance/clearance_bound.h"
#include "agent/laws/avoidance/repulsion.h"
#include "base/random.h"
#include "experiment/live_experiment.h"
#include "tests/support/folders.h"
#include "tests/support/ideal_network.h"
#include "tests/support/law_run.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string Point(const Eigen::Vector3d& p) {
  return "[" + ShortestFloat(p.x()) + ", " + ShortestFloat(p.y()) + ", " + ShortestFloat(p.z()) + "]";
}

/// An agent, and a pillar of 1 m diameter at x = 5. `law`: more lines of [law]; `more`: of other tables.
std::string PastAPillar(const std::string& model, const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W,
                        const std::string& law = "", const std::string& more = "") {
  return "[run]\nduration_s = 30\n[agents]\ncount = 1\nmodel = '" + model + "'\nposition_m = [" + Point(from_W) +
         "]\n[[physics.obstacles]]\nshape = 'cylinder'\nposition_m = [5, 0, 2]\nsize_m = [1, 1, 40]\n" +
         "[sensors]\nrange_m = 3.0\n" + more + "[law]\nname = 'avoidance'\ngoals_m = [" + Point(to_W) + "]\n" + law;
}

constexpr Repulsion kDefault{.gain = 0.5, .reach = 2.0 - kBallRadius_m};  // of a single integrator

// --- the equation -----------------------------------------------------------------------------------------

TEST(Avoidance, FarFromEverythingItFliesToItsGoalAtItsSpeedAndThenSlowsDown) {
  IdealNetwork far(PastAPillar("single_integrator", {0, 9, 2}, {-10, 9, 2}, "gain = 0.5\n"));
  EXPECT_LT((far.Wants()[0] - Eigen::Vector3d(-0.7, 0, 0)).norm(), 1e-12);
  far.agent(1).p_WB = {-9, 9, 2};
  EXPECT_LT((far.Wants()[0] - Eigen::Vector3d(-0.5, 0, 0)).norm(), 1e-12) << "a metre away, at gain 0.5";
}

TEST(Avoidance, AnObstacleThatIsSeenPushesAsKhatibsPotential) {
  IdealNetwork net(PastAPillar("single_integrator", {3.5, 0, 2}, {3.5, 0, 2}));  // at its goal, 1 m from the pillar
  const double c = 0.9, push = 0.5 * (1 / c - 1 / 1.9) / (c * c);
  EXPECT_LT((net.Wants()[0] - Eigen::Vector3d(-push, 0, 0)).norm(), 1e-12);
  net.agent(1).p_WB = {5, 2.6, 2};  // 2.1 m from it: no push, only the goal pulls
  EXPECT_NEAR(net.Wants()[0].normalized().dot(Eigen::Vector3d(-1.5, -2.6, 0).normalized()), 1, 1e-12);
  const double h = 1e-6;  // the push is the slope of the potential
  const auto potential = [](double at) { return 0.5 / 2 * (1 / at - 1 / 1.9) * (1 / at - 1 / 1.9); };
  EXPECT_NEAR(kDefault.Push(c), (potential(c - h) - potential(c + h)) / (2 * h), 1e-8);
  EXPECT_NEAR(kDefault.Steepness(c), (kDefault.Push(c - h) - kDefault.Push(c + h)) / (2 * h), 1e-6);
}

TEST(Avoidance, AgentsThatAreHeardPushAndOthersDoNot) {
  const auto two = [](const std::string& graph) {
    return "[run]\nduration_s = 30\n[agents]\ncount = 2\nmodel = 'single_integrator'\n"
           "position_m = [[0, 0, 1], [1, 0, 1]]\n[graph]\n" +
           graph + "[law]\nname = 'avoidance'\ngoals_m = [[0, 0, 1], [1, 0, 1]]\n";
  };
  IdealNetwork both(two("topology = 'complete'\n"));
  const double push = 0.5 * (1 / 0.8 - 1 / 1.8) / (0.8 * 0.8);
  EXPECT_LT((both.Wants()[0] - Eigen::Vector3d(-push, 0, 0)).norm(), 1e-12);
  EXPECT_LT((both.Wants()[1] - Eigen::Vector3d(push, 0, 0)).norm(), 1e-12);
  IdealNetwork one(two("edges = [[1, 2]]\n"));
  EXPECT_LT((one.Wants()[0] - Eigen::Vector3d(-push, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(one.Wants()[1], Eigen::Vector3d(0, 0, 0)) << "2 does not hear 1";
}

TEST(Avoidance, ObstaclesHaveTheLastWordOverAgents) {
  // Agent 2 pushes agent 1 towards the pillar as hard as can be; the pillar, 0.1 m away, pushes harder.
  IdealNetwork net(
      "[run]\nduration_s = 30\n[agents]\ncount = 2\nmodel = 'single_integrator'\n"
      "position_m = [[4.3, 0, 2], [4.05, 0, 2]]\n[[physics.obstacles]]\nshape = 'cylinder'\nposition_m = [5, 0, 2]\n"
      "size_m = [1, 1, 4]\n[sensors]\nrange_m = 3.0\n[law]\nname = 'avoidance'\n"
      "goals_m = [[9, 0, 2], [0, 0, 2]]\n");
  EXPECT_LT((net.Wants()[0] - Eigen::Vector3d(-0.7, 0, 0)).norm(), 1e-12);
}

// --- the bound --------------------------------------------------------------------------------------------

TEST(Avoidance, ASingleIntegratorThatIsPressedStopsWhereThePushIsItsSpeed) {
  const LawRun run(PastAPillar("single_integrator", {0, 0, 2}, {5, 0, 2}));  // its goal is in the pillar
  EXPECT_NEAR(kDefault.Push(run.Predicted("clearance_m")), 0.7, 1e-9);
  EXPECT_GE(run.Measured("clearance_m"), run.Predicted("clearance_m"));
  EXPECT_NEAR(run.Measured("clearance_m"), run.Predicted("clearance_m"), 1e-3) << "the bound is reached";
  EXPECT_EQ(run.Law()["bounds"]["clearance_m"], "at_least");
  EXPECT_TRUE(run.Law()["arrival_time_s"].is_null());
}

TEST(Avoidance, ADoubleIntegratorThatIsPressedComesNearlyAsCloseAsTheBound) {
  const std::string control = "[control]\nvelocity_gain = 2.0\nmax_acceleration_m_per_s2 = 4.0\n";
  const LawRun run(
      PastAPillar("double_integrator", {0, 0, 2}, {5, 0, 2}, "speed_m_per_s = 1.0\nrepulsion = 0.02\n", control));
  EXPECT_GE(run.Measured("clearance_m"), run.Predicted("clearance_m"));
  EXPECT_NEAR(run.Measured("clearance_m"), run.Predicted("clearance_m"), 0.025)
      << "less the tick of 1 cm, and steps of the bound that err on the safe side";
  EXPECT_LT(run.Predicted("clearance_m"), 0.9 * LawRun(PastAPillar("single_integrator", {0, 0, 2}, {5, 0, 2},
                                                                   "speed_m_per_s = 1.0\nrepulsion = 0.02\n"))
                                                    .Predicted("clearance_m"))
      << "it overshoots the balance";
}

/// The least clearance of an ideal agent among obstacles whose goal jumps somewhere else at random times.
double MinOfRestlessFlight(const std::string& toml, std::uint64_t seed) {
  auto now = std::make_shared<Experiment>(LoadExperiment(Section::FromText(toml, "test.toml"), "test"));
  Random random(seed, Random::Stream::kPositions);
  const std::shared_ptr<const Experiment> first = now;
  LiveExperiment live(*first, &LawTable(), /*checked=*/true);
  IdealNetwork net(toml);
  double min_m = 1e9;
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
  const AgentConfig& agent = first->agent(1);
  const bool by_velocity = agent.traits().driven_by == Wanted::kVelocity;
  std::shared_ptr<const Experiment> holder = first;
  for (int tick = 0; tick < 6000; ++tick) {
    if (tick % 150 == 0) {
      const std::string goal = Point({random.In(3, 7), random.In(-2, 2), random.In(0, 4)});
      holder = live.After(EventFrom(tick, "set = { \"law.goals_m\" = [" + goal + "] }", first->size(), "test"));
      net.laws[0]->Adopt(holder->agent(1));
    }
    const Eigen::Vector3d want_W = net.Wants()[0];
    const double h = net.h();
    Motion& motion = net.agent(1);
    const Eigen::Vector3d a_W = by_velocity ? Eigen::Vector3d((want_W - v_W) / h)
                                            : Eigen::Vector3d(agent.control.velocity_gain * (want_W - v_W));
    motion.p_WB += by_velocity ? Eigen::Vector3d(h * want_W) : Eigen::Vector3d(h * v_W + h * h / 2 * a_W);
    v_W += h * a_W;
    min_m = std::min(min_m, *Clearance_m(agent, motion.p_WB, first->physics.obstacles));
  }
  return min_m;
}

TEST(Avoidance, NoGoalsHoweverTheyJumpBringAnAgentNearerThanTheBound) {
  for (const std::string& model : {std::string("single_integrator"), std::string("double_integrator")})
    for (const std::string& law :
         {std::string("speed_m_per_s = 1.5\nrepulsion = 0.05\n"), std::string("repulsion = 0.02\ngain = 9.0\n")}) {
      const std::string toml =
          PastAPillar(model, {0, 0.1, 2}, {9, 0, 2}, law, "[control]\nmax_acceleration_m_per_s2 = 9.0\n");
      const Prediction prediction = Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test"));
      ASSERT_FALSE(prediction.law_figures.empty()) << prediction.silent;
      const double bound_m = *prediction.law_figures[0].values[0];
      EXPECT_GT(bound_m, 0);
      double min_m = 1e9;
      for (std::uint64_t seed = 1; seed <= 10; ++seed) min_m = std::min(min_m, MinOfRestlessFlight(toml, seed));
      EXPECT_GE(min_m, bound_m) << model << law;
      EXPECT_LT(min_m, bound_m + 0.1) << "the bound is not idle: " << model << law;
    }
}

TEST(Avoidance, ABoundThatIsNotAboveZeroIsNotTold) {
  const LawRun run(PastAPillar("double_integrator", {0, 1.3, 2}, {9, 0, 2}, "repulsion = 0.01\nspeed_m_per_s = 3.0\n",
                               "[control]\nmax_acceleration_m_per_s2 = 20.0\n"));
  EXPECT_TRUE(run.Law()["predicted"]["clearance_m"].is_null());
  EXPECT_EQ(run.Law()["reasons"]["clearance_m"], "the bound is not above 0: an agent may touch an obstacle");
  EXPECT_THAT(run.prediction.warnings, Contains("law.repulsion: too weak for law.speed_m_per_s: an agent that flies "
                                                "straight at an obstacle may touch it"));
  EXPECT_EQ(run.Law()["reasons"]["arrival_time_s"], "nothing is promised about arrival");
}

TEST(Avoidance, TheBoundCountsFromAStartThatIsNearer) {
  const LawRun run(PastAPillar("single_integrator", {4.2, 0, 2}, {0, 0, 2}));
  EXPECT_NEAR(run.Predicted("clearance_m"), 0.2, 1e-9) << "but for rounding";
  EXPECT_NEAR(run.Measured("clearance_m"), 0.2, 1e-12);
}

TEST(Avoidance, TheorySaysWhyItIsSilent) {
  const auto silent = [](const std::string& toml) {
    return Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test")).silent;
  };
  const auto past = [](const std::string& model, const std::string& law, const std::string& more = "") {
    return PastAPillar(model, {0, 0.5, 2}, {9, 0, 2}, law, more);
  };
  const std::string single = "single_integrator", pair = "double_integrator";
  EXPECT_EQ(silent(past(single, "")), "");
  EXPECT_EQ(silent(past(single, "repulsion = 0.0\n")), "law.repulsion is 0");
  EXPECT_EQ(silent(past(single, "axes = 'xy'\n")), "heights are held (law.axes), and the bound is of motion in space");
  EXPECT_EQ(silent(past(single, "", "own = { position_std_m = 0.1 }\n")), "what agents measure is noisy or late");
  EXPECT_EQ(silent(past("unicycle", "")), "the bound is of bodies that go where they are wanted");
  EXPECT_EQ(silent(past(single, "repulsion = 1e-6\n")),
            "the control period is too long for a repulsion as steep as this");
  EXPECT_EQ(silent(past(single, "", "[control]\nmax_speed_m_per_s = 0.5\n")),
            "control.max_speed_m_per_s cuts what the law asks for");
  EXPECT_EQ(LawRun(past(pair, "speed_m_per_s = 2.0\n")).Law()["bounds"]["clearance_m"], "within")
      << "the limit of the acceleration may cut: no bound";
  EXPECT_EQ(silent(past(pair, "", "[control]\nvelocity_gain = 200.0\nmax_acceleration_m_per_s2 = 1000.0\n")),
            "the velocity loop of agent 1 is unstable");
  EXPECT_EQ(
      silent(past(single, "", "[[physics.obstacles]]\nshape = 'sphere'\nposition_m = [5, 4, 2]\nsize_m = [1, 1, 1]\n")),
      "obstacles are less than twice law.influence_m apart: several push at once");
  EXPECT_EQ(silent("[run]\nduration_s = 9\n[agents]\ncount = 1\nmodel = 'single_integrator'\n[law]\nname = "
                   "'avoidance'\ngoals_m = [[0, 0, 1]]\n"),
            "there are no obstacles, and of agents among each other theory says nothing");
}

TEST(Avoidance, CheckWarnsOfAGoalInAnObstacle) {
  const auto warnings = [](const Eigen::Vector3d& goal_W) {
    const std::string toml = PastAPillar("single_integrator", {0, 0, 2}, goal_W);
    return Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test")).warnings;
  };
  EXPECT_THAT(warnings({5, 0.55, 2}), Contains("physics.obstacles: waypoint 1 of agent 1 is in obstacle 1, or closer "
                                               "than its body"));
  EXPECT_THAT(warnings({9, 0, 2}), Not(Contains(HasSubstr("obstacle")))) << "though the straight way leads through it";
}

// --- flights ----------------------------------------------------------------------------------------------

TEST(Avoidance, FliesAroundAPillarOnAllModels) {
  for (const char* model : {"single_integrator", "double_integrator", "quadrotor"}) {
    const LawRun run(PastAPillar(model, {0, 0.3, 2}, {10, 0, 2}));
    EXPECT_LT(run.Measured("arrival_time_s"), 25) << model;
    EXPECT_GE(run.Measured("clearance_m"), run.Predicted("clearance_m")) << model;
    EXPECT_EQ(run.summary["safety"]["contacts"]["obstacles"], 0) << model;
  }
}

TEST(Avoidance, AWallWithoutEndHoldsItUpWithoutAContact) {
  const LawRun run(
      "[run]\nduration_s = 30\n[agents]\ncount = 1\nmodel = 'double_integrator'\nposition_m = [[0, 0, 2]]\n"
      "[[physics.obstacles]]\nshape = 'box'\nposition_m = [5, 0, 2]\nsize_m = [1, 60, 60]\n[sensors]\nrange_m = 2.0\n"
      "[law]\nname = 'avoidance'\ngoals_m = [[10, 0.5, 2]]\n");
  EXPECT_TRUE(run.Law()["arrival_time_s"].is_null()) << "a local minimum";
  EXPECT_EQ(run.summary["safety"]["contacts"]["obstacles"], 0);
}

TEST(Avoidance, AGoalThatAnEventMovesIsReachedAnew) {
  const std::string to = "[[events]]\nat_s = 15.0\ngoto = { agent = 1, position_m = [0, 5, 2] }\n";
  const LawRun run(PastAPillar("single_integrator", {0, 5, 2}, {3, 5, 2}, "", to));
  EXPECT_NEAR(run.Measured("arrival_time_s"), 15 + 2.3 / 0.7 + std::log(0.7 / 0.2), 0.1)
      << "2.3 m at 0.7 m/s, then as exp(-t)";
}

/// The shipped obstacle course, with `repulsion`.
std::string Course(const std::string& repulsion) {
  std::string toml = ReadFile(test::SourceFolder() + "/configs/avoidance.toml");
  const std::string shipped = "repulsion = 0.5";
  return toml.replace(toml.rfind(shipped), shipped.size(), "repulsion = " + repulsion);
}

TEST(Avoidance, QuadrotorsPassTheCourseWithoutAContactAndWithoutRepulsionTheyDoNot) {
  const LawRun run(Course("0.5"));
  EXPECT_EQ(run.summary["safety"]["collisions"], 0);
  EXPECT_GE(run.Measured("clearance_m"), run.Predicted("clearance_m"));
  EXPECT_LT(run.Measured("arrival_time_s"), 35);
  EXPECT_THAT(run.prediction.warnings, Not(Contains(HasSubstr("physics.obstacles"))))
      << "its straight ways lead through pillars, which it avoids";
  const LawRun crash(Course("0.0"));
  EXPECT_GT(crash.summary["safety"]["contacts"]["obstacles"], 0);
  EXPECT_LT(crash.Measured("clearance_m"), 0);
}

}  // namespace
}  // namespace mascot
