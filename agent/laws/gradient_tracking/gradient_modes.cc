#include "agent/laws/gradient_tracking/gradient_modes.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/linear_algebra.h"

namespace mascot {
namespace {

constexpr double kFar = 1e-7, kNear = 1e-12;  // shares of the first error, between which the rate is measured

Eigen::MatrixXd Metropolis(const Graph& graph) {
  Eigen::MatrixXd w = Eigen::MatrixXd::Identity(graph.size(), graph.size());
  const auto degree = [&](int id) { return static_cast<double>(graph.HeardBy(id).size()); };
  for (int i = 1; i <= graph.size(); ++i)
    for (const Graph::Neighbour& j : graph.HeardBy(i)) {
      w(i - 1, j.id - 1) = MetropolisWeight(degree(i), degree(j.id));
      w(i - 1, i - 1) -= w(i - 1, j.id - 1);
    }
  return w;
}

}  // namespace

double GradientRadius(const Graph& graph, const std::vector<QuadraticCost>& costs, double step) {
  const Eigen::Index n = Eigen::Index{3} * graph.size();
  const Eigen::MatrixXd metropolis = Metropolis(graph);
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n, n), q = w;
  for (Eigen::Index i = 0; i < graph.size(); ++i) {
    q.block<3, 3>(3 * i, 3 * i) = costs[static_cast<std::size_t>(i)].q;
    for (Eigen::Index j = 0; j < graph.size(); ++j)
      w.block<3, 3>(3 * i, 3 * j) = metropolis(i, j) * Eigen::Matrix3d::Identity();
  }
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd m(2 * n, 2 * n);
  m << w, -step * identity, q * (w - identity), w - step * q;
  const Eigen::VectorXcd found = Eigenvalues(m);
  std::vector<std::complex<double>> roots(found.begin(), found.end());
  std::ranges::sort(roots, {}, [](const std::complex<double>& root) { return std::abs(root - 1.0); });
  double radius = 0;
  for (std::size_t k = 3; k < roots.size(); ++k) radius = std::max(radius, std::abs(roots[k]));
  return radius;
}

std::string UnstableStep(const Graph& graph, const std::vector<QuadraticCost>& costs, double step) {
  double stable = 0, unstable = step;
  for (int halving = 0; halving < 24; ++halving) {
    const double middle = (stable + unstable) / 2;
    (GradientRadius(graph, costs, middle) < 1 ? stable : unstable) = middle;
  }
  return fmt::format("law.step: unstable: expected below {:.4g} with these costs and this graph", stable);
}

void ApproachTicks::Add(std::int64_t tick, double largest_m) {
  newest_ = tick;
  newest_m_ = largest_m;
  if (first_m_ < 0) first_m_ = largest_m;
  if (largest_m > kFar * first_m_) last_far_ = tick;
  if (largest_m > kNear * first_m_) last_near_ = tick;
}

std::optional<double> ApproachTicks::rate_per_s(double period_s) const {
  if (last_far_ < 0 || last_near_ <= last_far_ || last_near_ >= newest_) return std::nullopt;
  return std::log(kFar / kNear) / (period_s * static_cast<double>(last_near_ - last_far_));
}

namespace {

/// Errors of estimates x and y, by id - 1, which obey
///   x+ = W x - step y,  y+ = W y + Q (x+ - x)
class GradientErrors {
 public:
  GradientErrors(const Experiment& experiment, const std::vector<QuadraticCost>& costs, double step)
      : costs_(costs), step_(step), w_(Metropolis(experiment.graph)) {
    const Eigen::Vector3d minimum_W = Minimiser(costs);
    x_.resize(experiment.size(), 3);
    y_ = x_;
    for (Eigen::Index i = 0; i < x_.rows(); ++i) {
      const Eigen::Vector3d& p_W = experiment.agents[static_cast<std::size_t>(i)].p_W;
      x_.row(i) = (p_W - minimum_W).transpose();
      y_.row(i) = costs[static_cast<std::size_t>(i)].Gradient(p_W).transpose();
    }
  }
  double largest_m() const { return x_.rowwise().norm().maxCoeff(); }
  void Iterate() {
    const Eigen::MatrixX3d next = w_ * x_ - step_ * y_;
    y_ = w_ * y_;
    for (Eigen::Index i = 0; i < x_.rows(); ++i)
      y_.row(i) += (costs_[static_cast<std::size_t>(i)].q * (next - x_).row(i).transpose()).transpose();
    x_ = next;
  }

 private:
  const std::vector<QuadraticCost>& costs_;
  double step_;
  Eigen::MatrixXd w_;
  Eigen::MatrixX3d x_, y_;
};

/// What rounding may leave of an error in the end, in estimates that are as far from the origin as the experiment's.
double RoundedError_m(const Experiment& experiment, const std::vector<QuadraticCost>& costs, double radius) {
  double farthest_m = Minimiser(costs).norm();
  for (const AgentConfig& agent : experiment.agents) farthest_m = std::max(farthest_m, agent.p_W.norm());
  return 3 * std::numeric_limits<double>::epsilon() * farthest_m / (1 - radius);
}

}  // namespace

GradientApproach ApproachOf(const Experiment& experiment, const std::vector<QuadraticCost>& costs, double step,
                            double radius) {
  constexpr std::int64_t kMaxTicks = 1'000'000;
  GradientErrors errors(experiment, costs, step);
  const double first_m = errors.largest_m();
  if (first_m == 0) return {.silent = "all estimates start where the sum of costs is least"};
  if (RoundedError_m(experiment, costs, radius) > kNear * first_m / 3)
    return {.silent = "rounding hides the last part of so small an error so far from the origin"};
  ApproachTicks ticks;
  std::optional<double> rate_per_s;
  for (std::int64_t tick = 0; tick < kMaxTicks; ++tick) {
    ticks.Add(tick, errors.largest_m());
    rate_per_s = ticks.rate_per_s(experiment.period_s());
    const bool for_good = tick == experiment.ticks() || tick - ticks.last_near() > ticks.last_near() / 4 + 100;
    if (rate_per_s && for_good) {
      const double slowest = -std::log(radius) * experiment.control.rate_hz;
      return {.rate = {.values = {*rate_per_s}, .beside = fmt::format("slowest mode {:.4g}", slowest)},
              .holds_from = HoldsFrom{experiment.time_s(ticks.last_near() + 1)}};
    }
    errors.Iterate();
  }
  return {.silent = "estimates approach the minimum for so many ticks that they are not flown ahead"};
}

void GradientMeter::Add(const TeamRow& row) {
  double largest_m = 0;
  for (const int id : ids_) {
    const auto& message = row.messages[static_cast<std::size_t>(id - 1)];
    if (message.size() < 3) return;  // its law is off
    largest_m = std::max(largest_m, (Eigen::Map<const Eigen::Vector3d>(message.data()) - minimum_W_).norm());
  }
  ticks_.Add(row.tick, largest_m);
}

std::vector<FigureValues> GradientMeter::Figures() const {
  return {{ticks_.rate_per_s(experiment_.period_s())}, {ticks_.newest_m()}};
}

}  // namespace mascot
