// Agent i knows its own state without delay, and its neighbours' states as they were m ticks ago. With control period
// h, z-transforms, x = z - 1, and d_i the sum of its weights, the sampled team (SampledTeam) moves by
//   [x^2 + own_i(z)] q_i = sum_j a_ij heard_i(z) z^-m q_j,                heard_i = h g_i x + h^2 p_i (1 + hold x)
//   own_i(z) = h b_i x + d_i heard_i(z)                                    for order 2, and
//   [x + d_i h p_i] q_i = sum_j a_ij h p_i z^-m q_j                        for order 1,
// if all agents have the same order and hold. A root z = e^(i theta), 0 < theta <= pi, requires an eigenvalue mu of
// M(z) = diag(heard_i / (x^2 + own_i)) A with mu z^-m = 1, that is, |mu| = 1 and m theta = arg(mu). The absolute row
// sums of M are less than 1 (no eigenvalue has magnitude 1: Gershgorin), with y = |x|^2 = 4 sin^2(theta / 2), where
//   low_i + steep_i y > 0
//   low_i = b_i^2 - 2 p_i d_i + b_i (2 g_i + (2 hold - 1) h p_i) d_i
//   steep_i = 1 - h b_i - h g_i d_i + (1 - hold) h^2 p_i d_i               for order 2, and where
//   low_i = 0, steep_i = 1 - h p_i d_i                                     for order 1.
// The smallest delay with a root thus belongs to a theta at which this fails for some i; if there is none, no delay has
// a root. The count of roots outside the unit circle changes with m only there, as long as this holds at theta = pi.
#include "orchestrator/theory/delay_margin.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "base/linear_algebra.h"

namespace mascot {
namespace {

using Complex = std::complex<double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A strongly connected component of the graph: its agents, the sums d_i of all their weights, and the adjacency matrix
/// A within it. Only agents of the same component form feedback loops.
struct Loop {
  std::vector<LinearAgent> agents;
  Eigen::VectorXd degree;
  Eigen::MatrixXd adjacency;
  double period_s;

  Loop(const LinearTeam& team, const Eigen::MatrixXd& laplacian, const std::vector<int>& ids, double h) : period_s(h) {
    std::vector<Eigen::Index> places;
    for (const int id : ids) {
      places.push_back(id - 1);
      agents.push_back(team.agent(id));
    }
    degree = laplacian.diagonal()(places);
    adjacency = -laplacian(places, places);
    adjacency.diagonal().setZero();
  }

  /// heard / (x^2 + own), or for order 1 h p / (x + d h p), of one agent at z = e^(i theta).
  Complex Gain(std::size_t i, double theta) const {
    const LinearAgent& agent = agents[i];
    const double d = degree(static_cast<Eigen::Index>(i)), h = period_s, half_sine = std::sin(theta / 2);
    const Complex x(-2 * half_sine * half_sine, std::sin(theta));
    if (agent.order == 1) return h * agent.p / (x + d * h * agent.p);
    const Complex heard = h * agent.g * x + h * h * agent.p * (1.0 + agent.hold * x);
    return heard / (x * (x + h * agent.b) + d * heard);
  }

  /// The theta from which on every eigenvalue has magnitude less than 1; 0: for every theta; nothing: not even at pi.
  std::optional<double> HighestFrequency() const {
    double highest_y = 0;
    for (std::size_t i = 0; i < agents.size(); ++i) {
      const LinearAgent& agent = agents[i];
      const double d = degree(static_cast<Eigen::Index>(i)), b = agent.b, h = period_s;
      double low = 0, steep = 1 - h * agent.p * d;  // low has the unit 1/s^2
      if (agent.order == 2) {
        low = b * b - 2 * agent.p * d + b * (2 * agent.g + (2 * agent.hold - 1) * h * agent.p) * d;
        steep = 1 - h * b - h * agent.g * d + (1 - agent.hold) * h * h * agent.p * d;
      }
      if (h * h * low + 4 * steep <= 0) return std::nullopt;
      if (low < 0) highest_y = std::max(highest_y, -h * h * low / steep);
    }
    // If all agents are alike and have equal sums of weights, the last crossing lies on the bound itself.
    constexpr double kBeyond = 1.001;
    return std::min(std::numbers::pi, kBeyond * 2 * std::asin(std::sqrt(highest_y) / 2));
  }

  /// Whether all agents have the same order and hold.
  bool IsHeldAlike() const {
    return std::ranges::all_of(agents, [&](const LinearAgent& agent) {
      return agent.order == agents.front().order && agent.hold == agents.front().hold;
    });
  }
  /// Whether all agents are alike and have equal sums of weights: then M is a scalar times A.
  bool IsRegular() const {
    return std::ranges::all_of(agents, [&](const LinearAgent& agent) { return agent.MovesAs(agents.front()); }) &&
           (degree.array() == degree(0)).all();
  }
};

using Spectrum = std::function<Eigen::VectorXcd(double theta)>;

/// The eigenvalues of M(e^(i theta)) as a function of theta, sorted by decreasing magnitude.
Spectrum SpectrumOf(const Loop& loop) {
  const auto sorted = [](Eigen::VectorXcd values) {
    std::ranges::sort(values, std::greater<>(), [](Complex value) { return std::norm(value); });
    return values;
  };
  if (loop.IsRegular()) {
    const Eigen::VectorXcd of_adjacency = sorted(Eigenvalues(loop.adjacency));
    return [&loop, of_adjacency](double theta) -> Eigen::VectorXcd { return loop.Gain(0, theta) * of_adjacency; };
  }
  return [&loop, sorted](double theta) -> Eigen::VectorXcd {
    Eigen::VectorXcd gains(loop.degree.size());
    for (Eigen::Index i = 0; i < gains.size(); ++i) gains(i) = loop.Gain(static_cast<std::size_t>(i), theta);
    const Eigen::MatrixXcd m = gains.asDiagonal() * loop.adjacency.cast<Complex>();
    return sorted(Eigenvalues(m));
  };
}

/// The theta in (low, high) at which the `rank`-th largest eigenvalue has magnitude 1.
double Crossing(const Spectrum& spectrum, Eigen::Index rank, double low, double high) {
  const bool rises = std::abs(spectrum(low)(rank)) < 1;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = (low + high) / 2;
    ((std::abs(spectrum(middle)(rank)) < 1) == rises ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// The smallest delay > 0 (ticks, not a whole number) of the eigenvalues that have magnitude 1, up to rounding, at
/// theta.
double DelayAt(const Spectrum& spectrum, double theta) {
  const Eigen::VectorXcd values = spectrum(theta);
  const Eigen::ArrayXd off = (values.array().abs() - 1).abs();
  double ticks = kInfinity;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (off(i) > off.minCoeff() + 1e-7) continue;
    const double angle = std::arg(values(i));
    ticks = std::min(ticks, (angle > 0 ? angle : angle + 2 * std::numbers::pi) / theta);
  }
  return ticks;
}

/// The smallest delay (ticks, not a whole number) over all theta up to `highest` at which an eigenvalue has magnitude
/// 1; infinite: there is none.
double Sweep(const Spectrum& spectrum, double highest) {
  constexpr int kSteps = 150;
  double ticks = kInfinity;
  double low = highest / 1e4;  // at theta = 0 the eigenvalue of agreement is 1 for any delay
  Eigen::VectorXcd at_low = spectrum(low);
  for (int step = 1; step <= kSteps; ++step) {
    const double high = highest * step / kSteps;
    const Eigen::VectorXcd at_high = spectrum(high);
    for (Eigen::Index rank = 0; rank < at_low.size(); ++rank) {
      if ((std::abs(at_low(rank)) < 1) == (std::abs(at_high(rank)) < 1)) continue;
      ticks = std::min(ticks, DelayAt(spectrum, Crossing(spectrum, rank, low, high)));
    }
    low = high;
    at_low = at_high;
  }
  return ticks;
}

}  // namespace

std::optional<DelayMargin> LinkDelayMargin(const LinearTeam& team, const Graph& graph, double period_s) {
  const Graph followed = team.Followed(graph);
  const Eigen::MatrixXd laplacian = followed.Laplacian();
  double ticks = kInfinity;
  for (const std::vector<int>& ids : followed.Components()) {
    if (ids.size() == 1) continue;
    const Loop loop(team, laplacian, ids, period_s);
    const std::optional<double> highest = loop.HighestFrequency();
    if (!loop.IsHeldAlike() || !highest) return std::nullopt;
    if (*highest == 0) continue;
    if (std::ssize(ids) > (loop.IsRegular() ? kLargestRegular : kLargestSweep)) return std::nullopt;
    ticks = std::min(ticks, Sweep(SpectrumOf(loop), *highest));
  }
  if (std::isinf(ticks)) return DelayMargin{.independent = true, .margin_s = std::nullopt};
  return DelayMargin{.independent = false, .margin_s = WholeTicks(ticks) * period_s};
}

}  // namespace mascot
