// Each law's printed equation (LawEntry::equation and details), evaluated in this file's own words, against what a body
// that flies by the law does in each of ten ticks.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kH = 0.02;  // the control period (s)
constexpr std::size_t kAgents = 4;
// a_ij, by id - 1.
constexpr std::array<std::array<double, kAgents>, kAgents> kWeight = {
    {{0, 0.5, 1.5, 0.8}, {0.5, 0, 1.0, 0}, {1.5, 1.0, 0, 2.0}, {0.8, 0, 2.0, 0}}};

const std::string kTeam =
    "run.duration_s = 0.2\ncontrol = { rate_hz = 50, max_speed_m_per_s = 1000.0, max_acceleration_m_per_s2 = 1000.0 }\n"
    "physics.collisions = false\nphysics.ground = false\noutput = { fidelity = false }\n";
const std::string kWeighted =
    "graph.edges = [[1, 2, 0.5], [2, 1, 0.5], [1, 3, 1.5], [3, 1, 1.5], [1, 4, 0.8], [4, 1, 0.8], [2, 3, 1.0], "
    "[3, 2, 1.0], [3, 4, 2.0], [4, 3, 2.0]]\n";
const std::string kStarts = "position_m = [[0.1, -0.3, 5], [3.2, 0.4, 5.5], [1.3, 2.6, 6], [-1.2, 1.7, 6.5]]";
const std::string kSingle = kTeam + "agents = { count = 4, model = 'single_integrator', " + kStarts + " }\n";
const std::string kDouble = kTeam + "agents = { count = 4, model = 'double_integrator', " + kStarts +
                            ", velocity_m_per_s = [[0.3, -0.2, 0], [0.1, 0.5, 0], [-0.4, 0.2, 0], [0.2, 0.1, 0]] }\n";
const std::string kOffsets = "offsets_m = [[0, 0, 0], [2, 0.5, 0], [1.5, 2, 0], [-0.5, 1.5, 0]]";
const std::string kSphere =
    "sensors.range_m = 20\nphysics.obstacles = [{ shape = 'sphere', position_m = [1, 1, 5], size_m = [1, 1, 1] }]\n";
const std::array<Vector3d, kAgents> kPlace = {Vector3d(0, 0, 0), Vector3d(2, 0.5, 0), Vector3d(1.5, 2, 0),
                                              Vector3d(-0.5, 1.5, 0)};

/// The team at one tick.
struct Now {
  double t_s = 0;
  std::size_t tick = 0;
  std::vector<Vector3d> p = {}, v = {};  // by id - 1
  double a(std::size_t i, std::size_t j) const { return kWeight[i][j]; }
};
/// sum_j a_ij term(j), over the neighbours of `i`.
Vector3d Sum(const Now& now, std::size_t i, const std::function<Vector3d(std::size_t)>& term) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t j = 0; j < kAgents; ++j)
    if (now.a(i, j) != 0) sum += now.a(i, j) * term(j);
  return sum;
}
Vector3d Pull(const Now& now, std::size_t i) {
  return Sum(now, i, [&](std::size_t j) -> Vector3d { return now.p[j] - now.p[i]; });
}
double SignOf(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
Vector3d InPlane(const Vector3d& x) { return {x.x(), x.y(), 0}; }

Vector3d ByConsensus(const Now& now, std::size_t i) {
  return Sum(now, i,
             [&](std::size_t j) -> Vector3d { return 0.7 * (now.p[j] - now.p[i]) + 0.3 * (now.v[j] - now.v[i]); }) -
         0.9 * now.v[i];
}

Vector3d ByFormation(const Now& now, std::size_t i) {
  if (i == 2) return Vector3d::Zero();  // the leader
  return -Sum(now, i, [&](std::size_t j) -> Vector3d {
    return 0.7 * ((now.p[i] - now.p[j]) - (kPlace[i] - kPlace[j])) + 0.3 * (now.v[i] - now.v[j]);
  }) - 0.9 * now.v[i];
}

Vector3d ByWaypoint(const Now& now, std::size_t i) { return 0.7 * (Vector3d(5, 4, 3) - now.p[i]) - 1.1 * now.v[i]; }

Vector3d ByMinmax(const Now& now, std::size_t c) {  // all hear the root, agent 1
  constexpr std::array<double, kAgents> kBeta = {0.5, 0.8, 0.9, 1.1};
  if (c == 0) return Vector3d::Zero();
  Vector3d a;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double z = (now.p[c] - now.p[0])[axis], w = (now.v[c] - now.v[0])[axis];
    a[axis] = -kBeta[c] * SignOf(2 * (kBeta[c] - kBeta[0]) * z + w * std::abs(w));
  }
  return a;
}

Vector3d ByVelocityConsensus(const Now& now, std::size_t i) {
  return i == 1 ? Vector3d::Zero().eval() : (0.7 * Pull(now, i)).eval();  // agent 2 leads
}

Vector3d ByPower(const Now& now, std::size_t i) {
  return 0.7 * Sum(now, i, [&](std::size_t j) -> Vector3d {
           return (now.p[j] - now.p[i]).unaryExpr([](double x) { return SignOf(x) * std::pow(std::abs(x), 0.4); });
         });
}
Vector3d BySign(const Now& now, std::size_t i) { return -0.7 * (-Pull(now, i)).unaryExpr(&SignOf); }

Vector3d ByPrescribedTime(const Now& now, std::size_t i) { return (0.4 + 2 / (3 - now.t_s)) * Pull(now, i); }

Vector3d ByRendezvous(const Now& now, std::size_t i) {
  Vector3d v = Vector3d::Zero();
  for (std::size_t j = 0; j < kAgents; ++j) {
    const double l = (now.p[j] - now.p[i]).norm(), range = 8;
    if (j != i) v += 0.7 * (2 * range - l) / ((range - l) * (range - l)) * (now.p[j] - now.p[i]);
  }
  return v;
}

// What agents said last, up to the tick before, from the thresholds alone.
Vector3d ByEventTriggered(const Now& now, std::size_t i) {
  static std::vector<std::vector<Vector3d>> said;  // by tick, by id - 1
  if (now.tick == 0 && i == 0) said.assign(1, {});
  const auto velocity = [&](std::size_t k) -> Vector3d {
    if (now.tick == 0) return Vector3d::Zero();
    const auto& x = said[now.tick];
    return 0.7 * Sum(now, k, [&](std::size_t j) -> Vector3d { return x[j] - x[k]; });
  };
  if (i == 0) {
    std::vector<Vector3d> next = now.tick == 0 ? now.p : said[now.tick];
    for (std::size_t k = 0; k < kAgents; ++k) {
      const Vector3d will_be = now.p[k] + kH * velocity(k);
      if (InPlane(next[k] - will_be).norm() > 0.01 + 0.03 * std::exp(-0.3 * (now.t_s + kH))) next[k] = will_be;
    }
    said.push_back(next);
  }
  return velocity(i);
}

Vector3d ByContainment(const Now& now, std::size_t i) {
  if (i == 0) return {0.1, 0.2, 0};
  if (i == 3) return {-0.1, 0.3, 0};
  return 0.7 * Pull(now, i);
}

Vector3d ByAverageTracking(const Now& now, std::size_t i) {
  static std::vector<std::vector<Vector3d>> x;  // by tick, by id - 1
  static std::vector<Vector3d> q;
  const std::array<Vector3d, kAgents> constant = {Vector3d(1, 0, 0), Vector3d(0, 2, 0), Vector3d(3, 1, 0),
                                                  Vector3d(-1, -1, 0)};
  if (i == 0) {
    if (now.tick == 0) {
      x.clear();
      q.assign(kAgents, Vector3d::Zero());
    } else {
      const std::vector<Vector3d> before = x.back();
      for (std::size_t k = 0; k < kAgents; ++k)
        q[k] += kH * 3 * Sum(now, k, [&](std::size_t j) -> Vector3d { return before[j] - before[k]; });
    }
    x.emplace_back();
    for (std::size_t k = 0; k < kAgents; ++k)
      x.back().push_back(constant[k] + Vector3d(0.1, 0.2, 0) * now.t_s +
                         Vector3d(0.5, 0, 0) * std::sin(2 * std::numbers::pi * 0.2 * now.t_s + 0.4) + q[k]);
  }
  const Vector3d x_i = x[now.tick][i];
  const Vector3d rate = now.tick == 0 ? Vector3d::Zero().eval() : ((x_i - x[now.tick - 1][i]) / kH).eval();
  return 1.3 * (x_i + kPlace[i] - now.p[i]) + rate;
}

Vector3d ByTrajectory(const Now& now, std::size_t i) {
  const double w = 2 * std::numbers::pi / 9, middle = w * (now.t_s + kH / 2), t = w * now.t_s;
  const Vector3d r(1 + 3 * std::cos(t), 2 + 3 * std::sin(t), 5), v_r(-3 * w * std::sin(t), 3 * w * std::cos(t), 0);
  const Vector3d a_r(-3 * w * w * std::cos(middle), -3 * w * w * std::sin(middle), 0);
  return a_r + 0.7 * (r + kPlace[i] - now.p[i]) + 1.1 * (v_r - now.v[i]);
}

Vector3d ByGradientTracking(const Now& now, std::size_t i) {
  static std::vector<Vector3d> x, y;
  const std::array<double, kAgents> weight = {1, 2, 0.5, 1.5};  // Q_i = weight I
  const std::array<Vector3d, kAgents> target = {Vector3d(1, 0, 0), Vector3d(0, 2, 0), Vector3d(3, 1, 0),
                                                Vector3d(-1, -1, 0)};
  const std::array<double, kAgents> degree = {3, 2, 3, 2};
  if (i == 0 && now.tick == 0) {
    x = now.p;
    y.clear();
    for (std::size_t k = 0; k < kAgents; ++k) y.push_back(weight[k] * (x[k] - target[k]));
  } else if (i == 0) {
    std::vector<Vector3d> x_next(kAgents), y_next(kAgents);
    for (std::size_t k = 0; k < kAgents; ++k) {
      double own = 1;
      Vector3d wx = Vector3d::Zero(), wy = Vector3d::Zero();
      for (std::size_t j = 0; j < kAgents; ++j) {
        if (now.a(k, j) == 0) continue;
        const double w = 1 / (1 + std::max(degree[k], degree[j]));
        own -= w;
        wx += w * x[j];
        wy += w * y[j];
      }
      x_next[k] = wx + own * x[k] - 0.03 * y[k];
      y_next[k] = wy + own * y[k] + weight[k] * (x_next[k] - x[k]);
    }
    x = x_next;
    y = y_next;
  }
  return 1.3 * (x[i] - now.p[i]);
}

Vector3d ByCyclicPursuit(const Now& now, std::size_t i) {
  const Vector3d way = now.p[(i + 1) % kAgents] - now.p[i];
  const double angle = 30 * std::numbers::pi / 180;
  return 0.7 * Vector3d(std::cos(angle) * way.x() + std::sin(angle) * way.y(),
                        -std::sin(angle) * way.x() + std::cos(angle) * way.y(), 0);
}

Vector3d ByDistanceFormation(const Now& now, std::size_t i) {
  return -0.05 * Sum(now, i, [&](std::size_t j) -> Vector3d {
    const Vector3d z = InPlane(now.p[i] - now.p[j]);
    return (z.squaredNorm() - (kPlace[i] - kPlace[j]).squaredNorm()) * z;
  });
}

Vector3d ByBearingFormation(const Now& now, std::size_t i) {
  return -0.7 * Sum(now, i, [&](std::size_t j) -> Vector3d {
    const Vector3d g = InPlane(now.p[j] - now.p[i]).normalized(), wanted = (kPlace[j] - kPlace[i]).normalized();
    return (Eigen::Matrix3d::Identity() - g * g.transpose()) * wanted;
  });
}

// Sampled by first-order holds, in closed form: what is held for a tick takes u, and the acceleration, exponentially to
// its end. The mean of the acceleration over the tick is what moves the body.
Vector3d ByPlatoon(const Now& now, std::size_t i) {
  constexpr double kHeadway = 0.5, kLag = 0.1, kP = 0.7, kD = 1.1, kDd = 0.2, kSpacing = 3, kSpeed = 5, kSwing = 0.5;
  static std::vector<double> u, u_said, a, rate;  // by id - 1
  static std::vector<Vector3d> v_before;
  const double w = 2 * std::numbers::pi / 10;
  if (i == 0) {
    if (now.tick == 0) {
      for (auto* of_all : {&u, &u_said, &a, &rate}) of_all->assign(kAgents, 0.0);
      v_before = now.v;
    }
    u_said = u;  // at the tick before
    for (std::size_t k = 0; k < kAgents; ++k) {
      if (k == 0) {
        const double middle = w * (now.t_s + kH / 2);
        u[0] = kSwing * w * std::cos(middle) - kLag * kSwing * w * w * std::sin(middle) +
               kD * (kSpeed + kSwing * std::sin(w * now.t_s) - now.v[0].x());
        continue;
      }
      const double a_k = (now.v[k].x() - v_before[k].x()) / kH;
      const double error = now.p[k - 1].x() - now.p[k].x() - kSpacing - kHeadway * now.v[k].x();
      const double error_rate = now.v[k - 1].x() - now.v[k].x() - kHeadway * a_k;
      const double jerk = now.tick == 0 ? 0 : (error_rate - rate[k]) / kH;
      const double end = kP * error + kD * error_rate + kDd * jerk + u_said[k - 1];
      u[k] = end + (u[k] - end) * std::exp(-kH / kHeadway);
      rate[k] = error_rate;
    }
    v_before = now.v;
  }
  const double kept = std::exp(-kH / kLag), mean = u[i] + (a[i] - u[i]) * kLag / kH * (1 - kept);
  a[i] = u[i] + (a[i] - u[i]) * kept;
  const double across =
      i == 0 ? -kD * now.v[0].y() : kP * (now.p[i - 1].y() - now.p[i].y()) + kD * (now.v[i - 1].y() - now.v[i].y());
  return {mean, across, 0};
}

Vector3d ByPursuitEvasion(const Now& now, std::size_t i) {
  if (i != 0) {
    if (now.a(i, 0) == 0) return Vector3d::Zero();
    return 1.5 * InPlane(now.p[0] - now.p[i]).normalized();
  }
  std::size_t nearest = 1;
  for (const std::size_t j : {std::size_t{2}, std::size_t{3}})
    if (InPlane(now.p[j] - now.p[0]).norm() < InPlane(now.p[nearest] - now.p[0]).norm()) nearest = j;
  return 0.6 * InPlane(now.p[0] - now.p[nearest]).normalized();
}

// Agents in a row, whose cells are strips of the region [-5, 5] x [-2, 4].
Vector3d ByCoverage(const Now& now, std::size_t i) {
  const double left = i == 0 ? -5 : (now.p[i - 1].x() + now.p[i].x()) / 2;
  const double right = i + 1 == kAgents ? 5 : (now.p[i].x() + now.p[i + 1].x()) / 2;
  return -0.7 * (InPlane(now.p[i]) - Vector3d((left + right) / 2, 1, 0));
}

// One follower, agent 4. Of four places in the plane the stresses are products of the factors of the one affine
// dependency, here r_4 = sum_j b_j r_j: they put the follower to sum_j b_j p_j.
Vector3d ByAffineFormation(const Now& now, std::size_t i) {
  if (i != 3) return 1.3 * (kPlace[i] - now.p[i]);
  Eigen::Matrix3d leaders;
  for (Eigen::Index j = 0; j < 3; ++j) leaders.col(j) << kPlace[static_cast<std::size_t>(j)].head<2>(), 1;
  const Vector3d b = leaders.inverse() * Vector3d(kPlace[3].x(), kPlace[3].y(), 1);
  return -0.7 * (now.p[3] - b(0) * now.p[0] - b(1) * now.p[1] - b(2) * now.p[2]);
}

Vector3d ByResilient(const Now& now, std::size_t i) {
  Vector3d v = Vector3d::Zero();
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    std::vector<std::pair<double, double>> above, below;
    for (std::size_t j = 0; j < kAgents; ++j)
      if (const double way = (now.p[j] - now.p[i])[axis]; now.a(i, j) != 0)
        (way > 0 ? above : below).emplace_back(std::abs(way), (way > 0 ? 1 : -1) * now.a(i, j));
    for (auto* side : {&above, &below}) {
      std::ranges::sort(*side);
      if (!side->empty()) side->pop_back();  // F = 1: the farthest
      for (const auto& [way, weight] : *side) v[axis] += 0.7 * way * weight;
    }
  }
  return v;
}

Vector3d ByFlocking(const Now& now, std::size_t i) {
  const double epsilon = 0.2, bump = 0.3, distance = 2, range = 3;
  const auto norm = [&](double l) { return (std::sqrt(1 + epsilon * l * l) - 1) / epsilon; };
  const auto rho = [](double z, double h) {
    return z < h ? 1 : z >= 1 ? 0 : (1 + std::cos(std::numbers::pi * (z - h) / (1 - h))) / 2;
  };
  const auto phi = [](double z) { return z / std::sqrt(1 + z * z); };
  const Vector3d p_r = Vector3d(4, 1, 0) + now.t_s * Vector3d(0.2, 0.1, 0);
  // The beta agent on a sphere about (1, 1, 5) of the radius 0.5 m.
  const Vector3d from_centre = now.p[i] - Vector3d(1, 1, 5), normal = from_centre.normalized();
  const Vector3d z_k = 0.5 * normal - from_centre;
  const Vector3d v_k = 0.5 / from_centre.norm() * (now.v[i] - normal * normal.dot(now.v[i]));
  const double s_k = norm(z_k.norm()), d_beta = norm(2.5);
  const Vector3d beta =
      z_k.norm() >= 2.5
          ? Vector3d::Zero().eval()
          : (2 * rho(s_k / d_beta, 0.9) * (phi(s_k - d_beta) - 1) * z_k / std::sqrt(1 + epsilon * z_k.squaredNorm()) +
             0.7 * rho(s_k / d_beta, 0.9) * (v_k - now.v[i]))
                .eval();
  return Sum(now, i,
             [&](std::size_t j) -> Vector3d {
               const Vector3d z = InPlane(now.p[j] - now.p[i]);
               const double s = norm(z.norm()), share = s / norm(range);
               const Vector3d n = z / std::sqrt(1 + epsilon * z.squaredNorm());
               return 1.2 * rho(share, bump) * phi(s - norm(distance)) * n +
                      0.8 * rho(share, bump) * (now.v[j] - now.v[i]);
             }) -
         0.3 * (now.p[i] - p_r) - 0.6 * (now.v[i] - Vector3d(0.2, 0.1, 0)) + beta;
}

Vector3d ByAvoidance(const Now& now, std::size_t i) {  // balls of 0.1 m; a sphere of the radius 0.5 m
  const auto cut = [](const Vector3d& x) -> Vector3d { return x.norm() > 2 ? x * (2 / x.norm()) : x; };
  const auto push = [](const Vector3d& away, double radii) -> Vector3d {
    const double c = away.norm() - radii, c0 = 3 - radii;
    return c < c0 ? 0.6 * (1 / c - 1 / c0) / (c * c) * away.normalized() : Vector3d::Zero().eval();
  };
  const std::array<Vector3d, kAgents> goal = {Vector3d(4, 0, 5), Vector3d(-4, 1, 5.5), Vector3d(1, -4, 6),
                                              Vector3d(2, 2, 6.5)};
  Vector3d f = 0.7 * (goal[i] - now.p[i]);
  for (std::size_t j = 0; j < kAgents; ++j)
    if (now.a(i, j) != 0) f += push(now.p[i] - now.p[j], 0.2);
  const Vector3d centre(1, 1, 5);
  const Vector3d nearest = centre + 0.5 * (now.p[i] - centre).normalized();
  return cut(cut(f) + push(now.p[i] - nearest, 0.1));
}

/// A printed equation, and the same in C++.
struct Equation {
  std::string name;  // of the case
  std::string law;
  std::string printed;  // a copy of LawEntry::equation: if one is changed, so must be the other, and `value`
  std::string toml;
  Vector3d (*value)(const Now& now, std::size_t i);  // wanted acceleration or velocity; called for i = 0..3 in turn
  double tolerance = 1e-9;

  friend void PrintTo(const Equation& one, std::ostream* out) { *out << one.name; }
};

std::vector<Equation> Equations() {
  return {
      {"consensus", "consensus",
       "a_i = sum_j a_ij [p_gain (p_j - p_i) + v_gain (v_j - v_i)] - beta v_i;  leader: a = 0, or its waypoints",
       kDouble + kWeighted + "law = { p_gain = 0.7, v_gain = 0.3, beta = 0.9 }", ByConsensus},
      {"waypoint", "waypoint", "a_i = p_gain (w - p_i) - d_gain v_i",
       kDouble + kWeighted + "law = { waypoints_m = [[5, 4, 3]], p_gain = 0.7, d_gain = 1.1 }", ByWaypoint},
      {"minmax", "minmax",
       "a_c = -beta_c sgn(2 (beta_c - beta_p) z + w |w|),  z = p_c - p_p,  w = v_c - v_p, per axis;  root: a = 0, or "
       "its waypoints",
       kDouble + kWeighted + "law = { leader = 1, beta = [0.5, 0.8, 0.9, 1.1] }", ByMinmax},
      {"formation", "formation",
       "a_i = -sum_j a_ij [p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j)] - beta v_i;  leader: a = 0, or its "
       "waypoints",
       kDouble + kWeighted + "law = { leader = 3, p_gain = 0.7, v_gain = 0.3, beta = 0.9, " + kOffsets + " }",
       ByFormation},
      {"velocity_consensus", "velocity_consensus", "v_i = p_gain sum_j a_ij (p_j - p_i)",
       kSingle + kWeighted + "law = { p_gain = 0.7, leader = 2 }", ByVelocityConsensus},
      {"finite_time_power", "finite_time",
       "v_i = gain sum_j a_ij sig(p_j - p_i)^alpha, per axis;  or  v_i = -gain sgn(sum_j a_ij (p_i - p_j))",
       kSingle + kWeighted + "law = { gain = 0.7, alpha = 0.4 }", ByPower},
      {"finite_time_sign", "finite_time",
       "v_i = gain sum_j a_ij sig(p_j - p_i)^alpha, per axis;  or  v_i = -gain sgn(sum_j a_ij (p_i - p_j))",
       kSingle + kWeighted + "law = { gain = 0.7, form = 'sign' }", BySign},
      {"prescribed_time", "prescribed_time",
       "v_i = (gain + exponent / (T - t)) sum_j a_ij (p_j - p_i);  from T on v_i = gain sum_j ...",
       kSingle + kWeighted + "law = { time_s = 3, exponent = 2, gain = 0.4 }", ByPrescribedTime},
      {"rendezvous", "rendezvous",
       "v_i = gain sum_j (2 D - l) / (D - l)^2 (p_j - p_i),  l = |p_j - p_i|, D = graph.range_m",
       kSingle + "graph = { topology = 'complete', range_m = 8 }\nlaw = { gain = 0.7 }", ByRendezvous},
      {"event_triggered", "event_triggered",
       "v_i = gain sum_j a_ij (x_j - x_i);  i says x_i = p_i when |x_i - p_i| > c0 + c1 exp(-alpha t)",
       kSingle + kWeighted + "law = { gain = 0.7, c0_m = 0.01, c1_m = 0.03, alpha = 0.3 }", ByEventTriggered},
      {"containment", "containment",
       "follower: v_i = gain sum_j a_ij (p_j - p_i);  leader: v_i = its own, 0 by default",
       kSingle + kWeighted +
           "law = { gain = 0.7, leaders = [1, 4], leader_velocities_m_per_s = [[0.1, 0.2, 0], [-0.1, 0.3, 0]] }",
       ByContainment},
      {"average_tracking", "average_tracking",
       "x_i = r_i + q_i,  dq_i/dt = gain sum_j a_ij (x_j - x_i);  v_i = p_gain (x_i + d_i - p_i) + dx_i/dt",
       kSingle + kWeighted +
           "[law]\ngain = 3\np_gain = 1.3\ninputs_m = [[1, 0, 0], [0, 2, 0], [3, 1, 0], [-1, -1, 0]]\nramps_m_per_s = "
           "[[0.1, 0.2, 0], [0.1, 0.2, 0], [0.1, 0.2, 0], [0.1, 0.2, 0]]\namplitudes_m = [[0.5, 0, 0], [0.5, 0, 0], "
           "[0.5, 0, 0], [0.5, 0, 0]]\nfrequencies_hz = [0.2, 0.2, 0.2, 0.2]\nphases_rad = [0.4, 0.4, 0.4, 0.4]\n" +
           kOffsets + "\n",
       ByAverageTracking},
      {"trajectory", "trajectory",
       "a_i = a_r + p_gain (r + d_i - p_i) + d_gain (v_r - v_i);  a_r only with feed_forward",
       kDouble + kWeighted + "law = { centre_m = [1, 2, 5], radius_m = 3, period_s = 9, p_gain = 0.7, d_gain = 1.1, " +
           kOffsets + " }",
       ByTrajectory},
      {"gradient_tracking", "gradient_tracking",
       "x_i+ = sum_j w_ij x_j - step y_i,  y_i+ = sum_j w_ij y_j + Q_i (x_i+ - x_i);  v_i = p_gain (x_i - p_i)",
       kSingle + kWeighted +
           "[law]\nstep = 0.03\np_gain = 1.3\ntargets_m = [[1, 0, 0], [0, 2, 0], [3, 1, 0], [-1, -1, 0]]\nweights = "
           "[[1.0], [2.0], [0.5], [1.5]]\n",
       ByGradientTracking},
      {"cyclic_pursuit", "cyclic_pursuit",
       "linear: v_i = gain R(alpha) (p_{i+1} - p_i), R(alpha) a turn to the right in x and y;  unicycles: at "
       "speed_m_per_s, "
       "or gain |p_{i+1} - p_i|, and turning by turn_gain times the angle to the next",
       kSingle + kWeighted + "law = { gain = 0.7, alpha_deg = 30 }", ByCyclicPursuit},
      {"distance_formation", "distance_formation", "v_i = -gain sum_j a_ij (|z|^2 - d_ij^2) z,  z = p_i - p_j",
       kSingle + kWeighted + "law = { gain = 0.05, " + kOffsets + " }", ByDistanceFormation},
      {"bearing_formation", "bearing_formation", "v_i = -gain sum_j a_ij P(g_ij) g*_ij,  P(g) = I - g g'",
       kSingle + kWeighted + "law = { gain = 0.7, " + kOffsets + " }", ByBearingFormation},
      {"platoon", "platoon",
       "headway u_i' = -u_i + p_gain e_i + d_gain e_i' + dd_gain e_i'' + u_{i-1}(t - theta), e_i = x_{i-1} - x_i - "
       "spacing - headway v_i;  tau a_i' = -a_i + u_i(t - phi);  agent 1: u_1 = v_r' + tau v_r'' + d_gain (v_r - v_1)",
       kTeam +
           "agents = { count = 4, model = 'double_integrator', position_m = [[0, 0, 5], [-5, 0.1, 5.5], [-11, -0.2, "
           "6], "
           "[-16, 0, 6.5]], velocity_m_per_s = [[5, 0, 0], [5.2, 0.1, 0], [4.8, 0, 0], [5, -0.1, 0]] }\n"
           "graph.topology = 'directed_path'\nlaw = { headway_s = 0.5, actuator_lag_s = 0.1, p_gain = 0.7, d_gain = "
           "1.1, dd_gain = 0.2, spacing_m = 3, speed_m_per_s = 5, disturbance_m_per_s = 0.5, disturbance_period_s = 10 "
           "}",
       ByPlatoon},
      {"pursuit_evasion", "pursuit_evasion",
       "v_i = pursuer_speed (p_e - p_i) / |p_e - p_i|;  evader: v_e = evader_speed (p_e - p_j) / |p_e - p_j|",
       kSingle + kWeighted + "law = { leader = 1, pursuer_speed_m_per_s = 1.5, evader_speed_m_per_s = 0.6 }",
       ByPursuitEvasion},
      {"coverage", "coverage", "v_i = -gain (p_i - C_i), C_i the centroid of i's Voronoi cell among what it hears",
       kTeam +
           "agents = { count = 4, model = 'single_integrator', position_m = [[-3, 0.2, 5], [-1, 0.2, 5], [1.5, 0.2, "
           "5], "
           "[3, 0.2, 5]] }\ngraph.topology = 'complete'\nlaw = { gain = 0.7, region_m = [[-5, -2], [5, -2], [5, 4], "
           "[-5, 4]] }",
       ByCoverage},
      {"affine_formation", "affine_formation",
       "follower: v_i = -gain sum_j omega_ij (p_i - p_j);  leader: to P_i(t) = A(t) r_i + b(t)",
       kSingle + "graph.topology = 'complete'\nlaw = { gain = 0.7, leader_gain = 1.3, leaders = [1, 2, 3], " +
           kOffsets + " }",
       ByAffineFormation},
      {"resilient", "resilient",
       "v_i = gain sum_j a_ij (p_j - p_i), per axis without the F largest above and the F smallest below",
       kSingle + kWeighted + "law = { gain = 0.7, f = 1 }", ByResilient},
      {"flocking", "flocking",
       "a_i = sum_j a_ij [c1_alpha phi_alpha(|p_j - p_i|_s) n_ij + c2_alpha rho_h(|p_j - p_i|_s / r_alpha) (v_j - "
       "v_i)] + sum_k [c1_beta phi_beta(|p_k - p_i|_s) n_ik + c2_beta rho_h(|p_k - p_i|_s / d_beta) (v_k - v_i)] - "
       "c1_gamma (p_i - p_r) - c2_gamma (v_i - v_r)",
       kDouble + kWeighted + kSphere +
           "law = { distance_m = 2, range_ratio = 1.5, epsilon = 0.2, bump = 0.3, c1_alpha = 1.2, c2_alpha = 0.8, "
           "c1_gamma = 0.3, c2_gamma = 0.6, c1_beta = 2, c2_beta = 0.7, obstacle_distance_m = 2.5, target_m = [4, 1, "
           "0], target_velocity_m_per_s = [0.2, 0.1, 0] }",
       ByFlocking, 1e-6},  // the velocity of a beta agent is a difference quotient over 1e-6 s
      {"avoidance", "avoidance",
       "v_i = [[gain (w_i - p_i) + sum_j push]_s + sum_k push]_s,  push = repulsion (1/c - 1/c0) / c^2",
       kSingle + kWeighted + kSphere +
           "law = { gain = 0.7, speed_m_per_s = 2, repulsion = 0.6, influence_m = 3, goals_m = [[4, 0, 5], [-4, 1, "
           "5.5], [1, -4, 6], [2, 2, 6.5]] }",
       ByAvoidance},
  };
}

/// The experiment of a case, whose law table does not name its law.
Experiment Read(const Equation& one) {
  std::string toml = one.toml;
  const bool is_inline = toml.find("law = { ") != std::string::npos;
  const std::string table = is_inline ? "law = { " : "[law]\n";
  toml.insert(toml.find(table) + table.size(), "name = '" + one.law + "'" + (is_inline ? ", " : "\n"));
  return LoadExperiment(Section::FromText(toml, "test.toml"), "test");
}

/// The motions of a run, tick by tick.
class Motions final : public RowSink {
 public:
  std::vector<std::vector<Motion>> ticks;

 private:
  void Add(const FlownRow& row) override { ticks.push_back(row.decoded().motions); }
};

class LawEquation : public testing::TestWithParam<Equation> {};

TEST_P(LawEquation, IsWhatABodyThatFliesByTheLawDoesInEveryTick) {
  const Equation& one = GetParam();
  const Experiment experiment = Read(one);
  const LawEntry& entry = EntryOf(experiment.law);
  ASSERT_EQ(entry.equation, one.printed);
  Motions flown;
  ASSERT_EQ(RunInProcess(experiment, {&flown}, [] { return true; }).failure, "");
  ASSERT_EQ(flown.ticks.size(), 11U);
  const bool is_velocity = WantedBy(experiment.law) == Wanted::kVelocity;
  const Eigen::Index axes = entry.axes == Axes::kXyz ? 3 : 2;
  double largest = 0;
  for (std::size_t k = 0; k + 1 < flown.ticks.size(); ++k) {
    Now now{.t_s = static_cast<double>(k) * kH, .tick = k};
    for (const Motion& motion : flown.ticks[k]) {
      now.p.push_back(motion.p_WB);
      now.v.push_back(motion.v_WB);
    }
    for (std::size_t i = 0; i < kAgents; ++i) {
      const Motion &before = flown.ticks[k][i], &after = flown.ticks[k + 1][i];
      const Vector3d did = is_velocity ? (after.p_WB - before.p_WB) / kH : (after.v_WB - before.v_WB) / kH;
      const Vector3d wanted = one.value(now, i);
      EXPECT_LT((did - wanted).head(axes).norm(), one.tolerance * (1 + wanted.norm()))
          << "agent " << i + 1 << ", tick " << k << ": did " << did.transpose() << ", the equation says "
          << wanted.transpose();
      largest = std::max(largest, wanted.head(axes).norm());
    }
  }
  EXPECT_GT(largest, 0.1);  // the agents do move
}

INSTANTIATE_TEST_SUITE_P(All, LawEquation, testing::ValuesIn(Equations()),
                         [](const auto& one) { return one.param.name; });

TEST(LawEquations, AreHeldOfAllLawsButThoseThatUsersMake) {
  std::set<std::string> held;
  for (const Equation& one : Equations()) held.insert(one.law);
  for (const LawEntry& law : Laws())
    EXPECT_EQ(held.contains(std::string(law.name)), law.name != "actions" && law.name != "custom" &&
                                                        law.name != "octave" && law.name != "plugin" &&
                                                        law.name != "policy" && law.name != "fmu")
        << law.name;
}

}  // namespace
}  // namespace mascot
