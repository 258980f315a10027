#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace mascot {

/// Direct simulation of a linear team along one axis, tick by tick, with delayed samples of neighbours and own state:
/// an independent reference for the predictions of theory.
///   u_i = sum_j A_ij [p_i (q_j - q_i) + g_i (v_j - v_i)] - b_i v_i,  order 1: q+ = q + h u;
///   order 2: q+ = q + h v + hold h^2 u, v+ = v + h u
struct DelayedRecursion {
  Eigen::MatrixXd adjacency;
  Eigen::VectorXd p, g, b;  // by agent
  int order = 2;
  double hold = 0.5;
  double h = 0.01;
  int link_ticks = 0;                 // delay of neighbours' samples; nothing is heard earlier
  int own_ticks = 0;                  // delay of own state; earlier, the initial state
  std::vector<Eigen::VectorXd> q, v;  // by tick

  DelayedRecursion(const Eigen::MatrixXd& a, double p_gain, double g_gain, double beta, const Eigen::VectorXd& start)
      : adjacency(a),
        p(Eigen::VectorXd::Constant(a.rows(), p_gain)),
        g(Eigen::VectorXd::Constant(a.rows(), g_gain)),
        b(Eigen::VectorXd::Constant(a.rows(), beta)),
        q{start},
        v{Eigen::VectorXd::Zero(a.rows())} {}

  void Step() {
    const int k = static_cast<int>(q.size()) - 1, then = std::max(0, k - own_ticks);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(p.size());
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      for (Eigen::Index j = 0; j < u.size() && k >= link_ticks; ++j)
        u(i) +=
            adjacency(i, j) * (p(i) * (q[k - link_ticks](j) - q[then](i)) + g(i) * (v[k - link_ticks](j) - v[then](i)));
      u(i) -= b(i) * v[then](i);
    }
    const bool first = order == 1;
    q.push_back(first ? Eigen::VectorXd(q[k] + h * u) : Eigen::VectorXd(q[k] + h * v[k] + hold * h * h * u));
    v.push_back(first ? u : Eigen::VectorXd(v[k] + h * u));
  }
  void RunFor(double time_s) {
    const double end = static_cast<double>(q.size()) + time_s / h;
    while (static_cast<double>(q.size()) < end) Step();
  }
  /// Largest disagreement in the last `time_s` of the run.
  double LateSpread(double time_s) const {
    double spread = 0;
    for (std::size_t k = q.size() - static_cast<std::size_t>(time_s / h); k < q.size(); ++k)
      spread = std::max(spread, q[k].maxCoeff() - q[k].minCoeff());
    return spread;
  }
  /// Runs for 3 times `time_s`. Returns whether the disagreement is smaller in the third part than in the second.
  bool Settles(double time_s) {
    RunFor(time_s);
    RunFor(time_s);
    const double early = LateSpread(time_s);
    RunFor(time_s);
    return LateSpread(time_s) < early;
  }
};

}  // namespace mascot
