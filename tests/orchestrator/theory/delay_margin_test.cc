#include "orchestrator/theory/delay_margin.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "tests/orchestrator/theory/delayed_recursion.h"

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

constexpr double kPeriod_s = 0.005;

/// Whether the team settles with this delay of neighbours' samples, by direct simulation.
bool Settles(const Eigen::MatrixXd& a, const LinearAgent& agent, double delay_s) {
  DelayedRecursion witness(a, agent.p, agent.g, agent.b, Start(a.rows()));
  witness.order = agent.order;
  witness.hold = agent.hold;
  witness.h = kPeriod_s;
  witness.link_ticks = static_cast<int>(std::lround(delay_s / witness.h));
  return witness.Settles(60);
}

/// Whether the team settles if neighbours' samples come `late` ticks late, with control period h, by the eigenvalues of
/// the map of all states and past states over one tick. They are 1 (agreement), and inside the unit circle.
bool Settles(const Eigen::MatrixXd& a, const std::vector<LinearAgent>& agents, double h, int late) {
  const Eigen::Index n = a.rows(), size = 2 * n * (late + 1),
                     old = 2 * n * late;  // q, v now, then of 1, 2, ... ticks ago
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < n; ++i) {
    const LinearAgent& agent = agents[static_cast<std::size_t>(i)];
    Eigen::RowVectorXd u = Eigen::RowVectorXd::Zero(size);
    for (Eigen::Index j = 0; j < n; ++j) {
      u(old + j) += a(i, j) * agent.p;
      u(i) -= a(i, j) * agent.p;
      u(old + n + j) += a(i, j) * agent.g;
      u(n + i) -= a(i, j) * agent.g;
    }
    u(n + i) -= agent.b;
    map.row(i) = agent.order == 1 ? h * u : agent.hold * h * h * u;
    map.row(n + i) = agent.order == 1 ? u : h * u;
    map(i, i) += 1;
    if (agent.order == 2) map(i, n + i) += h, map(n + i, n + i) += 1;
  }
  if (late > 0) map.bottomLeftCorner(size - 2 * n, size - 2 * n).setIdentity();
  return Eigen::VectorXcd(map.eigenvalues()).cwiseAbs().maxCoeff() < 1 + 1e-9;
}

TEST(LinkDelay, NeverHarmsTeamsOfOrderOne) {
  const LinearAgent agent{.order = 1, .hold = 1, .p = 2.0};
  for (const Eigen::MatrixXd& a : {Path(5), DirectedRing(6), Asymmetric()}) {
    const auto margin = LinkDelayMargin(Alike(a.rows(), agent), FromAdjacency(a), kPeriod_s);
    ASSERT_TRUE(margin);
    EXPECT_TRUE(margin->independent);
    EXPECT_FALSE(margin->margin_s);
    EXPECT_TRUE(Settles(a, agent, 3.0));
  }
}

TEST(LinkDelay, NeverHarmsTeamsOfOrderTwoThatAreDampedWell) {
  // b^2 + 2 b g d >= 2 p d for all agents; on a path d <= 2.
  for (const LinearAgent& agent : {LinearAgent{.p = 1, .b = 2}, {.p = 2, .g = 0.5, .b = 2.0}}) {
    const auto margin = LinkDelayMargin(Alike(5, agent), FromAdjacency(Path(5)), kPeriod_s);
    ASSERT_TRUE(margin);
    EXPECT_TRUE(margin->independent);
    for (const double delay_s : {0.5, 2.0, 5.0}) EXPECT_TRUE(Settles(Path(5), agent, delay_s)) << delay_s;
  }
}

struct Case {
  Eigen::MatrixXd adjacency;
  LinearAgent agent;
};

TEST(LinkDelay, HarmsFromItsMarginOnToTheTick) {
  const Case cases[] = {
      {Path(5), {.p = 2.0, .b = 0.5}},         {Path(3), {.p = 1.0, .b = 0.3}},
      {Asymmetric(), {.p = 1.0, .b = 0.9}},    {Asymmetric(), {.p = 1.0, .g = 0.2, .b = 0.6}},
      {DirectedRing(5), {.p = 0.5, .b = 0.9}}, {Path(4), {.hold = 1, .p = 1.5, .b = 0.4}},
      {Ring(4), {.p = 1.0, .b = 0.5}},         {Ring(5), {.p = 1.0, .g = 0.1, .b = 0.5}},
      {Path(3), {.p = 1.0, .g = 0.3}},         {Path(2), {.hold = 1, .p = 3.0, .g = 0.2, .b = 0.1}},
  };
  for (const Case& c : cases)
    for (const double h : {0.19, 0.1, 0.05}) {
      const LinearTeam team = Alike(c.adjacency.rows(), c.agent);
      if (!Settles(c.adjacency, team.agents, h, 0)) continue;
      const auto margin = LinkDelayMargin(team, FromAdjacency(c.adjacency), h);
      ASSERT_TRUE(margin && margin->margin_s) << c.adjacency;
      const int ticks = static_cast<int>(std::lround(*margin->margin_s / h));
      EXPECT_NEAR(*margin->margin_s, ticks * h, 1e-12);
      for (int late = std::max(0, ticks - 3); late < ticks; ++late)
        EXPECT_TRUE(Settles(c.adjacency, team.agents, h, late)) << c.adjacency << "\n"
                                                                << h << " " << ticks << " " << late;
      EXPECT_FALSE(Settles(c.adjacency, team.agents, h, ticks)) << c.adjacency << "\n" << h << " " << ticks;
    }
}

TEST(LinkDelay, OfRandomTeamsWhoseAgentsDifferHarmsFromItsMarginOnToTheTick) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int known = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 2 + trial % 3;
    const double h = 0.05 + 0.2 * unit(random), hold = trial % 2 == 0 ? 0.5 : 1.0;
    Eigen::MatrixXd a = DirectedRing(n);
    LinearTeam team = Alike(n, {});
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) a(i, j) = i == j ? 0 : (a(i, j) + (unit(random) < 0.4)) * (0.5 + unit(random));
      team.agents[static_cast<std::size_t>(i)] = {
          .hold = hold, .p = 0.5 + 1.5 * unit(random), .g = 0.3 * unit(random), .b = 0.2 + unit(random)};
    }
    if (!Settles(a, team.agents, h, 0)) continue;
    const auto margin = LinkDelayMargin(team, FromAdjacency(a), h);
    ASSERT_TRUE(margin) << a;
    const int ticks = margin->independent ? 30 : static_cast<int>(std::lround(*margin->margin_s / h));
    for (const int late : {1, ticks / 2, ticks - 1})
      if (late < ticks) {
        EXPECT_TRUE(Settles(a, team.agents, h, late)) << a << "\n" << h << " " << ticks << " " << late;
      }
    if (margin->independent || ticks > 30) continue;
    EXPECT_FALSE(Settles(a, team.agents, h, ticks)) << a << "\n" << h << " " << ticks;
    ++known;
  }
  EXPECT_GT(known, 30);
}

TEST(LinkDelay, OfAPairHasAClosedForm) {
  // Two agents that hear each other: M = (p / (p - w^2 + i b w)) A, where A has eigenvalues 1 and -1. Those of M have
  // magnitude 1 at w^2 = 2 p - b^2, where e^(i w tau) = +-p / (p - w^2 + i b w).
  const double p = 1, b = 0.6, w = std::sqrt(2 * p - b * b), short_s = 1e-5;
  const double angle = -std::atan2(b * w, p - w * w);
  const double expected_s = (angle + std::numbers::pi) / w;  // for the eigenvalue -1: half a turn more
  const auto margin = LinkDelayMargin(Alike(2, {.p = p, .b = b}), FromAdjacency(Path(2)), short_s);
  ASSERT_TRUE(margin && margin->margin_s);
  EXPECT_NEAR(*margin->margin_s, expected_s, 3 * short_s);
}

TEST(LinkDelay, OfTeamsWithEqualSumsOfWeightsHasAClosedForm) {
  // All d_i = d. For an eigenvalue mu of A with |mu| = d, that of M has magnitude 1 at w^2 = 2 p d - b^2, where
  // e^(i w tau) = mu p / (p d - w^2 + i b w). Without a period, that is; with one that is short, it is nearly so.
  constexpr double kShort_s = 1e-6;
  for (const Eigen::MatrixXd& a : {Ring(4), DirectedRing(4), DirectedRing(7)}) {
    const double d = a.row(0).sum();
    for (double b = 0.05; b < std::sqrt(2 * d); b += 0.05) {
      if (!Settles(a, Alike(a.rows(), {.p = 1, .b = b}).agents, 1e-3, 0)) continue;  // directed rings need damping
      const double w = std::sqrt(2 * d - b * b);
      double expected_s = std::numeric_limits<double>::infinity();
      for (const Complex mu : Eigen::VectorXcd(a.eigenvalues())) {
        if (std::abs(mu) < d - 1e-9) continue;
        const double angle = std::arg(mu / (d - w * w + Complex(0, b * w)));
        expected_s = std::min(expected_s, (angle > 0 ? angle : angle + 2 * std::numbers::pi) / w);
      }
      const auto margin = LinkDelayMargin(Alike(a.rows(), {.p = 1, .b = b}), FromAdjacency(a), kShort_s);
      ASSERT_TRUE(margin && margin->margin_s) << a << "\nb = " << b;
      EXPECT_NEAR(*margin->margin_s, expected_s, 1e-5 * (1 + expected_s / b)) << a << "\nb = " << b;
    }
  }
}

TEST(LinkDelay, IsUnknownWherePeriodsAreLong) {
  // Agents of order one that are moved farther than to where they are drawn (h p d > 1): rows of M sum to more than 1.
  EXPECT_FALSE(LinkDelayMargin(Alike(2, {.order = 1, .hold = 1, .p = 1.1}), FromAdjacency(Path(2)), 1.0));
  EXPECT_TRUE(LinkDelayMargin(Alike(2, {.order = 1, .hold = 1, .p = 0.9}), FromAdjacency(Path(2)), 1.0));
}

TEST(LinkDelay, IsUnknownForAgentsThatAreHeldInDifferentWays) {
  LinearTeam team = Alike(2, {.p = 1, .b = 1});
  team.agents[1].hold = 1;
  EXPECT_FALSE(LinkDelayMargin(team, FromAdjacency(Path(2)), kPeriod_s));
}

TEST(LinkDelay, MarginDoesNotDependOnTheNumbersOfTheAgents) {
  const Eigen::Index order[] = {2, 0, 3, 1};
  const LinearAgent agent{.p = 1.0, .g = 0.1, .b = 0.6};
  Eigen::MatrixXd renamed(4, 4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) renamed(i, j) = Asymmetric()(order[i], order[j]);
  const auto one = LinkDelayMargin(Alike(4, agent), FromAdjacency(Asymmetric()), kPeriod_s);
  const auto other = LinkDelayMargin(Alike(4, agent), FromAdjacency(renamed), kPeriod_s);
  ASSERT_TRUE(one && one->margin_s && other && other->margin_s);
  EXPECT_EQ(*one->margin_s, *other->margin_s);
}

TEST(LinkDelay, NeverHarmsTeamsWithoutFeedbackLoops) {
  // A directed chain has no feedback loops, so that even with little damping no delay matters.
  Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(30, 30);
  for (int i = 1; i < 30; ++i) chain(i, i - 1) = 1;
  const auto margin = LinkDelayMargin(Alike(30, {.p = 5, .b = 0.1}), FromAdjacency(chain), kPeriod_s);
  ASSERT_TRUE(margin);
  EXPECT_TRUE(margin->independent);
}

TEST(LinkDelay, IsUnknownForManyAgentsThatDiffer) {
  const LinearAgent agent{.p = 5, .b = 0.1};
  EXPECT_FALSE(LinkDelayMargin(Alike(kLargestSweep + 1, agent), FromAdjacency(Path(kLargestSweep + 1)), kPeriod_s));
  EXPECT_TRUE(LinkDelayMargin(Alike(100, agent), FromAdjacency(DirectedRing(100)), kPeriod_s));
}

}  // namespace
}  // namespace mascot
