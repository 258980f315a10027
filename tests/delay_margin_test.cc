#include "orchestrator/theory/delay_margin.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "tests/delayed_recursion.h"

namespace mascot {
namespace {

using Complex = std::complex<double>;

Graph FromAdjacency(const Eigen::MatrixXd& a) {
  std::vector<std::vector<Graph::Neighbour>> heard(static_cast<std::size_t>(a.rows()));
  for (int i = 0; i < a.rows(); ++i)
    for (int j = 0; j < a.cols(); ++j)
      if (a(i, j) > 0) heard[static_cast<std::size_t>(i)].push_back({j + 1, a(i, j)});
  return Graph(std::move(heard));
}

LinearTeam Alike(Eigen::Index count, const LinearAgent& agent) {
  return {std::vector<LinearAgent>(static_cast<std::size_t>(count), agent),
          std::vector<Eigen::Vector3d>(static_cast<std::size_t>(count), Eigen::Vector3d::Zero())};
}

Eigen::MatrixXd Path(int n) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i + 1 < n; ++i) a(i, i + 1) = a(i + 1, i) = 1;
  return a;
}

Eigen::MatrixXd DirectedRing(int n) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) a(i, (i + n - 1) % n) = 1;
  return a;
}

Eigen::MatrixXd Ring(int n) { return DirectedRing(n) + DirectedRing(n).transpose(); }

/// Adjacency matrix of a strongly connected graph without any symmetry.
Eigen::MatrixXd Asymmetric() {
  Eigen::MatrixXd a(4, 4);
  a << 0, 1.2, 0, 0.3, 0.5, 0, 0.9, 0, 0, 0, 0, 1.7, 0.8, 0, 0.4, 0;
  return a;
}

Eigen::VectorXd Start(Eigen::Index n) {
  return Eigen::VectorXd::LinSpaced(n, -1, 2).array().sin() + Eigen::VectorXd::LinSpaced(n, 1, 3).array().square();
}

/// Whether the team settles with this delay of neighbours' samples, by direct simulation.
bool Settles(const Eigen::MatrixXd& a, const LinearAgent& agent, double delay_s, double time_s = 60) {
  DelayedRecursion witness(a, agent.p, agent.g, agent.b, Start(a.rows()));
  witness.order = agent.order;
  witness.hold = agent.hold;
  witness.h = 0.005;
  witness.link_ticks = static_cast<int>(std::lround(delay_s / witness.h));
  return witness.Settles(time_s);
}

TEST(LinkDelay, NeverHarmsTeamsOfOrderOne) {
  const LinearAgent agent{.order = 1, .hold = 1, .p = 2.0};
  for (const Eigen::MatrixXd& a : {Path(5), DirectedRing(6), Asymmetric()}) {
    const auto margin = LinkDelayMargin(Alike(a.rows(), agent), FromAdjacency(a));
    ASSERT_TRUE(margin);
    EXPECT_TRUE(margin->independent);
    EXPECT_FALSE(margin->margin_s);
    EXPECT_TRUE(Settles(a, agent, 3.0));
  }
}

TEST(LinkDelay, NeverHarmsTeamsOfOrderTwoThatAreDampedWell) {
  // b^2 + 2 b g d >= 2 p d for all agents; on a path d <= 2.
  for (const LinearAgent& agent : {LinearAgent{.p = 1, .b = 2}, {.p = 2, .g = 0.5, .b = 2.0}}) {
    const auto margin = LinkDelayMargin(Alike(5, agent), FromAdjacency(Path(5)));
    ASSERT_TRUE(margin);
    EXPECT_TRUE(margin->independent);
    for (const double delay_s : {0.5, 2.0, 5.0}) EXPECT_TRUE(Settles(Path(5), agent, delay_s)) << delay_s;
  }
}

struct Case {
  Eigen::MatrixXd adjacency;
  LinearAgent agent;
};

TEST(LinkDelay, HarmsFromItsMarginOn) {
  const Case cases[] = {
      {Path(5), {.p = 2.0, .b = 0.5}},         {Path(3), {.p = 1.0, .b = 0.3}},
      {Asymmetric(), {.p = 1.0, .b = 0.9}},    {Asymmetric(), {.p = 1.0, .g = 0.2, .b = 0.6}},
      {DirectedRing(5), {.p = 0.5, .b = 0.9}}, {Path(4), {.hold = 1, .p = 1.5, .b = 0.4}},
      {Ring(4), {.p = 1.0, .b = 0.5}},         {Ring(5), {.p = 1.0, .g = 0.1, .b = 0.5}},
  };
  for (const Case& c : cases) {
    const auto margin = LinkDelayMargin(Alike(c.adjacency.rows(), c.agent), FromAdjacency(c.adjacency));
    ASSERT_TRUE(margin);
    ASSERT_TRUE(margin->margin_s) << c.adjacency;
    EXPECT_TRUE(Settles(c.adjacency, c.agent, 0.95 * *margin->margin_s - 0.01, 120)) << *margin->margin_s;
    EXPECT_FALSE(Settles(c.adjacency, c.agent, 1.05 * *margin->margin_s + 0.01, 120)) << *margin->margin_s;
  }
}

TEST(LinkDelay, OfAPairHasAClosedForm) {
  // Two agents that hear each other: M = (p / (p - w^2 + i b w)) A, where A has eigenvalues 1 and -1. Those of M have
  // magnitude 1 at w^2 = 2 p - b^2, where e^(i w tau) = +-p / (p - w^2 + i b w).
  const double p = 1, b = 0.6, w = std::sqrt(2 * p - b * b);
  const double angle = -std::atan2(b * w, p - w * w);
  const double expected_s = (angle + std::numbers::pi) / w;  // for the eigenvalue -1: half a turn more
  const auto margin = LinkDelayMargin(Alike(2, {.p = p, .b = b}), FromAdjacency(Path(2)));
  ASSERT_TRUE(margin && margin->margin_s);
  EXPECT_NEAR(*margin->margin_s, expected_s, 1e-6);
}

TEST(LinkDelay, OfTeamsWithEqualSumsOfWeightsHasAClosedForm) {
  // All d_i = d. For an eigenvalue mu of A with |mu| = d, that of M has magnitude 1 at w^2 = 2 p d - b^2, where
  // e^(i w tau) = mu p / (p d - w^2 + i b w).
  for (const Eigen::MatrixXd& a : {Ring(4), DirectedRing(4), DirectedRing(7)}) {
    const double d = a.row(0).sum();
    for (double b = 0.05; b < std::sqrt(2 * d); b += 0.05) {
      const double w = std::sqrt(2 * d - b * b);
      double expected_s = std::numeric_limits<double>::infinity();
      for (const Complex mu : Eigen::VectorXcd(a.eigenvalues())) {
        if (std::abs(mu) < d - 1e-9) continue;
        const double angle = std::arg(mu / (d - w * w + Complex(0, b * w)));
        expected_s = std::min(expected_s, (angle > 0 ? angle : angle + 2 * std::numbers::pi) / w);
      }
      const auto margin = LinkDelayMargin(Alike(a.rows(), {.p = 1, .b = b}), FromAdjacency(a));
      ASSERT_TRUE(margin && margin->margin_s) << a << "\nb = " << b;
      EXPECT_NEAR(*margin->margin_s, expected_s, 1e-6) << a << "\nb = " << b;
    }
  }
}

TEST(LinkDelay, MarginDoesNotDependOnTheNumbersOfTheAgents) {
  const Eigen::Index order[] = {2, 0, 3, 1};
  const LinearAgent agent{.p = 1.0, .g = 0.1, .b = 0.6};
  Eigen::MatrixXd renamed(4, 4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) renamed(i, j) = Asymmetric()(order[i], order[j]);
  const auto one = LinkDelayMargin(Alike(4, agent), FromAdjacency(Asymmetric()));
  const auto other = LinkDelayMargin(Alike(4, agent), FromAdjacency(renamed));
  ASSERT_TRUE(one && one->margin_s && other && other->margin_s);
  EXPECT_NEAR(*one->margin_s, *other->margin_s, 1e-6);
}

TEST(LinkDelay, NeverHarmsTeamsWithoutFeedbackLoops) {
  // A directed chain has no feedback loops, so that even with little damping no delay matters.
  Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(30, 30);
  for (int i = 1; i < 30; ++i) chain(i, i - 1) = 1;
  const auto margin = LinkDelayMargin(Alike(30, {.p = 5, .b = 0.1}), FromAdjacency(chain));
  ASSERT_TRUE(margin);
  EXPECT_TRUE(margin->independent);
}

TEST(LinkDelay, IsUnknownForManyAgentsThatDiffer) {
  const LinearAgent agent{.p = 5, .b = 0.1};
  EXPECT_FALSE(LinkDelayMargin(Alike(kLargestSweep + 1, agent), FromAdjacency(Path(kLargestSweep + 1))));
  EXPECT_TRUE(LinkDelayMargin(Alike(100, agent), FromAdjacency(DirectedRing(100))));
}

}  // namespace
}  // namespace mascot
