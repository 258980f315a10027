#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mascot {

/// The ideal body that a vehicle follows: a double integrator in W with the accelerations that its agent has commanded,
/// each held until the next: p(k+1) = p(k) + v(k) T + a(k) T^2 / 2, v(k+1) = v(k) + a(k) T, T = 1 / rate.
class Reference {
 public:
  /// `p_W`, `v_W`: at tick 0 (m, m/s).
  Reference(const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W, double rate_hz)
      : rate_hz_(rate_hz), p_W_(p_W), v_W_(v_W) {}

  /// Takes the agent's acceleration (m/s^2) at `tick`. That of the newest tick before it was held until then; older
  /// ones are too late, and are not taken.
  void Take(std::int64_t tick, const Eigen::Vector3d& a_W);

  /// Begins anew at `tick`, at `p_W` with `v_W`.
  void Restart(std::int64_t tick, const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W) {
    *this = Reference(p_W, v_W, rate_hz_);
    tick_ = tick;
  }

  std::int64_t tick() const { return tick_; }
  // At tick(), in W (m, m/s, m/s^2).
  const Eigen::Vector3d& p_W() const { return p_W_; }
  const Eigen::Vector3d& v_W() const { return v_W_; }
  const Eigen::Vector3d& a_W() const { return a_W_; }

 private:
  double rate_hz_;
  std::int64_t tick_ = 0;
  Eigen::Vector3d p_W_, v_W_, a_W_ = Eigen::Vector3d::Zero();
};

}  // namespace mascot
