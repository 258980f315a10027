// Agent i knows its own state without delay, and its neighbours' states with delay tau. With d_i the sum of its
// weights,
//   [s^n + own_i(s)] q_i = sum_j a_ij (p_i + g_i s) e^(-s tau) q_j
//   own_i(s) = p_i d_i (order n = 1)  or  (b_i + g_i d_i) s + p_i d_i (n = 2).
// A root at s = i w, w > 0, requires an eigenvalue mu of M(w) = diag((p_i + g_i s) / (s^n + own_i(s))) A with
// mu e^(-i w tau) = 1, that is, |mu| = 1 and tau = arg(mu) / w. The absolute row sums of M are less than 1
//   for n = 1 always, and
//   for n = 2 where w^2 > 2 p_i d_i - b_i^2 - 2 b_i g_i d_i.
// If they are for all i, no eigenvalue has magnitude 1 (Gershgorin). The smallest delay with a root thus belongs to a
// frequency w at which the second condition fails for some i; if there is none, no delay has a root.
#include "orchestrator/theory/delay_margin.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "experiment/linear_algebra.h"

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

  Loop(const LinearTeam& team, const Eigen::MatrixXd& laplacian, const std::vector<int>& ids) {
    std::vector<Eigen::Index> places;
    for (const int id : ids) {
      places.push_back(id - 1);
      agents.push_back(team.agent(id));
    }
    degree = laplacian.diagonal()(places);
    adjacency = -laplacian(places, places);
    adjacency.diagonal().setZero();
  }

  /// (p + g s) / (s^n + own(s)) of one agent at s = i w.
  Complex Gain(std::size_t i, double w) const {
    const LinearAgent& agent = agents[i];
    const double d = degree(static_cast<Eigen::Index>(i));
    const Complex s(0, w), heard = agent.p + agent.g * s;
    return heard / ((agent.order == 1 ? s : s * (s + agent.b)) + heard * d);
  }

  /// The frequency w (rad/s) from which on every eigenvalue has magnitude less than 1; 0: at every frequency.
  double HighestFrequency() const {
    double highest2 = 0;
    for (std::size_t i = 0; i < agents.size(); ++i) {
      const LinearAgent& agent = agents[i];
      const double d = degree(static_cast<Eigen::Index>(i)), b = agent.b;
      if (agent.order == 2) highest2 = std::max(highest2, 2 * agent.p * d - b * b - 2 * b * agent.g * d);
    }
    // If all agents are alike and have equal sums of weights, the last crossing lies on the bound itself.
    constexpr double kBeyond = 1.001;
    return kBeyond * std::sqrt(highest2);
  }

  /// Whether all agents are alike and have equal sums of weights: then M is a scalar times A.
  bool IsRegular() const {
    return std::ranges::all_of(agents, [&](const LinearAgent& agent) { return agent.MovesAs(agents.front()); }) &&
           (degree.array() == degree(0)).all();
  }
};

using Spectrum = std::function<Eigen::VectorXcd(double w)>;

/// The eigenvalues of M(w) as a function of w, sorted by decreasing magnitude.
Spectrum SpectrumOf(const Loop& loop) {
  const auto sorted = [](Eigen::VectorXcd values) {
    std::ranges::sort(values, std::greater<>(), [](Complex value) { return std::abs(value); });
    return values;
  };
  if (loop.IsRegular()) {
    const Eigen::VectorXcd of_adjacency = Eigenvalues(loop.adjacency);
    return
        [&loop, of_adjacency, sorted](double w) -> Eigen::VectorXcd { return sorted(loop.Gain(0, w) * of_adjacency); };
  }
  return [&loop, sorted](double w) -> Eigen::VectorXcd {
    Eigen::VectorXcd gains(loop.degree.size());
    for (Eigen::Index i = 0; i < gains.size(); ++i) gains(i) = loop.Gain(static_cast<std::size_t>(i), w);
    const Eigen::MatrixXcd m = gains.asDiagonal() * loop.adjacency.cast<Complex>();
    return sorted(Eigenvalues(m));
  };
}

/// The frequency in (low, high) at which the `rank`-th largest eigenvalue has magnitude 1.
double Crossing(const Spectrum& spectrum, Eigen::Index rank, double low, double high) {
  const bool rises = std::abs(spectrum(low)(rank)) < 1;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = (low + high) / 2;
    ((std::abs(spectrum(middle)(rank)) < 1) == rises ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// The smallest delay tau > 0 (s) of the eigenvalues that have magnitude 1, up to rounding, at frequency w.
double DelayAt(const Spectrum& spectrum, double w) {
  const Eigen::VectorXcd values = spectrum(w);
  const Eigen::ArrayXd off = (values.array().abs() - 1).abs();
  double tau_s = kInfinity;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (off(i) > off.minCoeff() + 1e-7) continue;
    const double angle = std::arg(values(i));
    tau_s = std::min(tau_s, (angle > 0 ? angle : angle + 2 * std::numbers::pi) / w);
  }
  return tau_s;
}

/// The smallest delay tau (s) over all frequencies up to `highest` at which an eigenvalue has magnitude 1.
std::optional<double> Sweep(const Spectrum& spectrum, double highest) {
  constexpr int kSteps = 150;
  std::optional<double> margin_s;
  double low = highest / 1e4;  // at w = 0 the eigenvalue of agreement is 1 for any delay
  Eigen::VectorXcd at_low = spectrum(low);
  for (int step = 1; step <= kSteps; ++step) {
    const double high = highest * step / kSteps;
    const Eigen::VectorXcd at_high = spectrum(high);
    for (Eigen::Index rank = 0; rank < at_low.size(); ++rank) {
      if ((std::abs(at_low(rank)) < 1) == (std::abs(at_high(rank)) < 1)) continue;
      margin_s = std::min(margin_s.value_or(kInfinity), DelayAt(spectrum, Crossing(spectrum, rank, low, high)));
    }
    low = high;
    at_low = at_high;
  }
  return margin_s;
}

}  // namespace

std::optional<DelayMargin> LinkDelayMargin(const LinearTeam& team, const Graph& graph) {
  const Graph followed = team.Followed(graph);
  const Eigen::MatrixXd laplacian = followed.Laplacian();
  std::optional<double> margin_s;
  for (const std::vector<int>& ids : followed.Components()) {
    if (ids.size() == 1) continue;
    const Loop loop(team, laplacian, ids);
    const double highest = loop.HighestFrequency();
    if (highest == 0) continue;
    if (std::ssize(ids) > (loop.IsRegular() ? kLargestRegular : kLargestSweep)) return std::nullopt;
    const std::optional<double> own_s = Sweep(SpectrumOf(loop), highest);
    if (own_s) margin_s = std::min(margin_s.value_or(kInfinity), *own_s);
  }
  return DelayMargin{.independent = !margin_s, .margin_s = margin_s};
}

}  // namespace mascot
