#include "orchestrator/theory/sampled_team.h"

#include <gtest/gtest.h>

#include <cmath>

#include "agent/laws/laws.h"
#include "tests/orchestrator/theory/delayed_recursion.h"

namespace mascot {
namespace {

const Eigen::VectorXd kStart = (Eigen::VectorXd(5) << 3, -1, 4, 1, -5).finished();

/// Five agents that start at kStart. `rest`: lines from [control] on.
std::string Five(const std::string& model, const std::string& rest) {
  return "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 5\nmodel = '" + model +
         "'\nposition_m = [[3, 0, 1], [-1, 0, 1], [4, 0, 1], [1, 0, 1], [-5, 0, 1]]\n[control]\nrate_hz = 10\n" + rest;
}

const std::string kPathGraph = "[graph]\ntopology = 'path'\n";

struct Case {
  Experiment experiment;
  LinearTeam team;
  Timeline timeline;
  SampledTeam sampled;

  explicit Case(const std::string& toml)
      : experiment(LoadExperiment(Section::FromText(toml, "test.toml"), "test")),
        team(LinearTeamOf(experiment).team.value()),
        timeline(TimelineOf(experiment).value()),
        sampled(experiment, team, timeline, experiment.period_s()) {}

  DelayedRecursion Witness() const {
    const LinearAgent& moves = team.agents.front();
    Eigen::MatrixXd a = -experiment.graph.Laplacian();
    a.diagonal().setZero();
    DelayedRecursion witness(a, moves.p, moves.g, moves.b, kStart);
    witness.order = moves.order;
    witness.hold = moves.hold;
    witness.h = experiment.period_s();
    return witness;
  }
};

/// Decay rate of the disagreement (1/s), measured after `time_s`.
double Rate(DelayedRecursion& witness, double time_s) {
  witness.RunFor(time_s);
  const double early = witness.LateSpread(time_s / 4);
  witness.RunFor(time_s);
  return std::log(early / witness.LateSpread(time_s / 4)) / time_s;
}

TEST(SampledTeam, OfOrderOneIsTheSampledMapOfTheLaplacian) {
  const Case path(Five("single_integrator", kPathGraph + "[law]\nname = 'velocity_consensus'\n"));
  EXPECT_NEAR(path.sampled.slowest(), 1 - 0.1 * 0.381966, 1e-7);
  EXPECT_NEAR(path.sampled.rate_per_s(), -std::log(1 - 0.1 * 0.381966) / 0.1, 1e-6);
  EXPECT_NEAR(path.sampled.MeetingPoint().x(), 0.4, 1e-12);
}

TEST(SampledTeam, MeetsWhereADelayOfOneTickSendsIt) {
  const Case delayed(
      Five("single_integrator", kPathGraph + "[link]\ndelay_s = 0.1\n[law]\nname = 'velocity_consensus'\n"));
  EXPECT_NEAR(delayed.sampled.MeetingPoint().x(), 0.448275862, 1e-9);
}

TEST(SampledTeam, MovesAsItsRecursionDoesForEveryLawModelAndDelay) {
  for (const std::string model : {"single_integrator", "double_integrator"}) {
    for (const std::string law : {"'velocity_consensus'\np_gain = 0.8", "'consensus'\np_gain = 0.7\nv_gain = 0.3"}) {
      for (const auto& [link, own] : {std::pair(0, 0), {1, 0}, {3, 0}, {2, 2}, {2, 1}, {0, 1}}) {
        const Case c(Five(model, kPathGraph + "[sensors.own]\ndelay_s = " + ShortestFloat(0.1 * own) +
                                     "\n[link]\ndelay_s = " + ShortestFloat(0.1 * link) + "\n[law]\nname = " + law));
        DelayedRecursion witness = c.Witness();
        witness.link_ticks = link;
        witness.own_ticks = own;
        const std::string what = model + " " + law + " " + std::to_string(link) + " " + std::to_string(own);
        ASSERT_TRUE(c.sampled.Decays()) << what;
        const double rate = Rate(witness, 30);
        EXPECT_NEAR(c.sampled.rate_per_s(), rate, 0.03 * rate) << what;
        witness.RunFor(100);
        EXPECT_NEAR(c.sampled.MeetingPoint().x(), witness.q.back().mean(), 1e-6) << what;
      }
    }
  }
}

TEST(SampledTeam, FindsTheDelayFromWhichOnItDoesNotSettle) {
  for (int ticks = 1; ticks <= 9; ++ticks) {
    const std::string delay = "delay_s = " + ShortestFloat(0.1 * ticks) + "\n";
    const Case c(Five("single_integrator", "[sensors.own]\n" + delay + kPathGraph + "[link]\n" + delay +
                                               "[law]\nname = 'velocity_consensus'\np_gain = 0.6\n"));
    DelayedRecursion witness = c.Witness();
    witness.link_ticks = witness.own_ticks = ticks;
    EXPECT_EQ(c.sampled.Decays(), witness.Settles(60)) << ticks;
  }
}

TEST(SampledTeam, OnASwitchingGraphIsTheProductOfItsPhases) {
  const Case c(Five("single_integrator",
                    "[graph]\nedges = [[1, 2], [2, 1], [4, 5]]\nrepeat_s = 1.2\n"
                    "[[graph.schedule]]\nat_s = 0.5\nedges = [[2, 3], [3, 2, 0.5], [3, 4], [5, 4]]\n"
                    "[[graph.schedule]]\nat_s = 0.9\nedges = [[1, 5], [4, 3]]\n[law]\nname = 'velocity_consensus'\n"));
  Eigen::VectorXd x = kStart;
  double early = 0;
  for (int k = 0; k < 2400; ++k) {
    const Eigen::MatrixXd l = c.experiment.schedule.At(0.1 * k).Laplacian();
    x -= 0.1 * l * x;
    if (k == 119) early = x.maxCoeff() - x.minCoeff();
    if (k == 239) {
      EXPECT_NEAR(std::log(early / (x.maxCoeff() - x.minCoeff())) / 12, c.sampled.rate_per_s(), 1e-3);
    }
  }
  EXPECT_NEAR(c.sampled.MeetingPoint().x(), x.mean(), 1e-9);
}

TEST(SampledTeam, WithDelayedSwitchingEdgesUsesSamplesSentWhileTheyExisted) {
  const Case c(Five("double_integrator",
                    "[graph]\nedges = [[1, 2], [2, 1], [4, 5], [5, 4]]\nrepeat_s = 1.0\n"
                    "[[graph.schedule]]\nat_s = 0.4\nedges = [[2, 3], [3, 2], [3, 4], [4, 3]]\n"
                    "[link]\ndelay_s = 0.2\n[law]\nname = 'consensus'\nbeta = 1.5\n"));
  std::vector<Eigen::VectorXd> q = {kStart}, v = {Eigen::VectorXd::Zero(5)};
  for (int k = 0; k < 4000; ++k) {
    Eigen::VectorXd u = -1.5 * v.back();
    if (k >= 2) {
      const Eigen::MatrixXd l = c.experiment.schedule.At(0.1 * (k - 2)).Laplacian();
      const Eigen::VectorXd d = l.diagonal();
      u += (Eigen::MatrixXd(d.asDiagonal()) - l) * q[k - 2] - d.cwiseProduct(q[k]);
    }
    q.push_back(q[k] + 0.1 * v[k] + 0.005 * u);
    v.push_back(v[k] + 0.1 * u);
  }
  ASSERT_TRUE(c.sampled.Decays());
  EXPECT_NEAR(c.sampled.MeetingPoint().x(), q.back().mean(), 1e-9);
}

TEST(SampledTeam, TakesAgentsThatStartLateIntoAccount) {
  const Case c(Five("single_integrator", kPathGraph + "[law]\nname = 'velocity_consensus'\n") +
               "[[agents.override]]\nid = 5\nstart_s = 2.0\n");
  Eigen::VectorXd x = kStart;
  const Eigen::MatrixXd l = c.experiment.graph.Laplacian();
  Eigen::MatrixXd without = l;
  without.row(4).setZero();
  without.row(3) << 0, 0, -1, 1, 0;
  for (int k = 0; k < 2000; ++k) x -= 0.1 * (k < 20 ? without : l) * x;
  EXPECT_NEAR(c.sampled.MeetingPoint().x(), x.mean(), 1e-9);
}

TEST(SampledTeam, ComputesTheEqualEigenvaluesOfAChainAccurately) {
  // Ten equal poles: a solver for the whole matrix would scatter them.
  const Case c(
      "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 11\nmodel = 'single_integrator'\n"
      "[graph]\ntopology = 'directed_path'\n[link]\ndelay_s = 0.01\n[law]\nname = 'velocity_consensus'\nleader = 1\n");
  EXPECT_NEAR(c.sampled.slowest(), 0.99, 1e-12);
}

TEST(SampledTeam, DoesNotCountCommonBrakingAsDisagreement) {
  // Disagreement decays by s^2 + 0.3 s + lambda; the common velocity, or that of a root without neighbours, by s + 0.3,
  // which is slower.
  const std::string law = "[law]\nname = 'consensus'\nbeta = 0.3\nv_gain = 1.5\np_gain = 1.0\n";
  const Case together(Five("double_integrator", "[graph]\ntopology = 'complete'\n[link]\ndelay_s = 0.1\n" + law));
  const Case root(Five("double_integrator",
                       "[[agents.override]]\nid = 3\nlaw = { p_gain = 1.2 }\n"
                       "[graph]\nedges = [[2, 1], [3, 1], [4, 1], [5, 1]]\n" +
                           law));
  for (const Case* c : {&together, &root}) {
    DelayedRecursion witness = c->Witness();
    witness.link_ticks = c == &together ? 1 : 0;
    if (c == &root) witness.p(2) = 1.2;
    ASSERT_TRUE(c->sampled.Decays());
    const double rate = Rate(witness, 12);
    EXPECT_GT(rate, 0.4);
    EXPECT_NEAR(c->sampled.rate_per_s(), rate, 0.1 * rate);
  }
}

TEST(SampledTeam, ScalesWeightsByTheLongRunDeliveryOfLinks) {
  const Case half(Five("single_integrator", kPathGraph + "[link]\nloss = 0.4\n[law]\nname = 'velocity_consensus'\n"));
  EXPECT_NEAR(half.sampled.slowest(), 1 - 0.06 * 0.381966, 1e-7);
  const Case bursts(Five(
      "single_integrator",
      kPathGraph + "[law]\nname = 'velocity_consensus'\n[link]\ngilbert_elliott = { good_to_bad = 0.1, bad_to_good = "
                   "0.3, loss_good = 0.2, loss_bad = 1.0 }\n"));
  EXPECT_NEAR(bursts.sampled.slowest(), 1 - 0.1 * 0.75 * 0.8 * 0.381966, 1e-7);
}

}  // namespace
}  // namespace mascot
