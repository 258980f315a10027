#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace mascot {

/// How each vehicle of a string follows the one before it, along one axis; Ploeg, Scheepers, van Nunen, van de Wouw &
/// Nijmeijer, "Design and experimental evaluation of cooperative adaptive cruise control" (ITSC 2011):
/// tau a' = -a + u(t - phi)                          the vehicle: its acceleration a follows its command u
///   e = x_before - x - spacing - headway v            the error of the distance
/// headway u' = -u + p e + d e' + dd e'' + u_before(t - theta)    the controller; without u_before: ACC Here vehicle
/// and controller are sampled: what a controller knows is held for a tick of `h` seconds.
struct Following {
  double p = 0;   ///< 1/s^2
  double d = 0;   ///< 1/s
  double dd = 0;  ///< 1
  double headway_s = 0;
  double lag_s = 0;          ///< tau
  int delay_ticks = 0;       ///< phi
  bool feed_forward = true;  ///< u_before, by message
  int message_ticks = 1;     ///< theta: age of the message in ticks, at least 1
  double h = 0;              ///< the control period (s)

  /// The fraction of the way to its final value that u goes in a tick.
  double Approach() const { return headway_s > 0 ? -std::expm1(-h / headway_s) : 1; }
  /// Answer(): the same fraction for the vehicle's acceleration. MeanOfOld(): the fraction of its old value in its mean
  /// over the tick.
  double Answer() const { return lag_s > 0 ? -std::expm1(-h / lag_s) : 1; }
  double MeanOfOld() const { return lag_s / h * Answer(); }
};

/// Returns the value that was put in `ticks` calls ago; 0 before that.
class DelayLine {
 public:
  explicit DelayLine(int ticks) : ring_(static_cast<std::size_t>(ticks), 0.0) {}
  double Pass(double value) {
    if (ring_.empty()) return value;
    std::swap(value, ring_[at_]);
    at_ = (at_ + 1) % ring_.size();
    return value;
  }

 private:
  std::vector<double> ring_;
  std::size_t at_ = 0;
};

/// The vehicle of Following. A body that takes what MeanAcceleration() returns for a tick has at its end the velocity
/// of a vehicle with that lag and delay.
class LaggedVehicle {
 public:
  explicit LaggedVehicle(int delay_ticks) : told_(delay_ticks) {}
  double MeanAcceleration(const Following& law, double u) {
    u = told_.Pass(u);
    const double mean = u + law.MeanOfOld() * (a_ - u);
    a_ += law.Answer() * (u - a_);
    return mean;
  }

 private:
  DelayLine told_;
  double a_ = 0;
};

/// The controller of Following.
class FollowingControl {
 public:
  explicit FollowingControl(int message_ticks) : told_(message_ticks - 1) {}
  double u() const { return u_; }
  /// Computes u of the next tick from the error e (m), its rate e' (m/s), and the newest u that the vehicle before has
  /// sent.
  void Follow(const Following& law, double error_m, double rate_m_per_s, double u_before) {
    double r = law.p * error_m + law.d * rate_m_per_s;
    if (has_rate_) r += law.dd * (rate_m_per_s - rate_m_per_s_) / law.h;
    u_before = told_.Pass(u_before);
    if (law.feed_forward) r += u_before;
    u_ += law.Approach() * (r - u_);
    rate_m_per_s_ = rate_m_per_s;
    has_rate_ = true;
  }
  /// Computes u of a tick at which nothing is known of the vehicle before: u goes to 0.
  void LetGo(const Following& law) {
    u_ -= law.Approach() * u_;
    has_rate_ = false;
  }

 private:
  DelayLine told_;
  double u_ = 0, rate_m_per_s_ = 0;
  bool has_rate_ = false;
};

}  // namespace mascot
