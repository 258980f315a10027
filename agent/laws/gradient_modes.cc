#include "agent/laws/gradient_modes.h"

#include <fmt/format.h>

#include <cmath>

#include "experiment/linear_algebra.h"

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

void GradientMeter::Add(const TeamRow& row) {
  newest_m_ = 0;
  newest_ = row.tick;
  for (const int id : ids_) {
    const auto& message = row.messages[static_cast<std::size_t>(id - 1)];
    if (message.size() < 3) return;  // its law is off
    newest_m_ = std::max(newest_m_, (Eigen::Map<const Eigen::Vector3d>(message.data()) - minimum_W_).norm());
  }
  if (first_m_ < 0) first_m_ = newest_m_;
  if (newest_m_ > kFar * first_m_) last_far_ = row.tick;
  if (newest_m_ > kNear * first_m_) last_near_ = row.tick;
}

std::vector<FigureValues> GradientMeter::Figures() const {
  std::optional<double> rate_per_s;
  if (last_far_ >= 0 && last_near_ > last_far_ && last_near_ < newest_)
    rate_per_s = std::log(kFar / kNear) / experiment_.time_s(last_near_ - last_far_);
  return {{rate_per_s}, {newest_m_}};
}

}  // namespace mascot
