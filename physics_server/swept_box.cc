#include "physics_server/swept_box.h"

#include <algorithm>
#include <limits>

namespace mascot {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// How far the centre goes at most (m).
double MaxWay(const Motion& state, const SweptBody& body, const PushLimit& limit, double wind_m_per_s, double time_s) {
  if (limit.speed_m_per_s) return *limit.speed_m_per_s * time_s;
  // While the speed grows by a t, drag grows, too: a <= a_now + drag/m a t.
  const double speed = state.v_WB.norm();
  const double growth = limit.drag_kg_per_s / body.mass_kg * time_s;
  if (!(growth < 0.5)) return kUnlimited;
  const double now = limit.force_n / body.mass_kg + body.gravity_m_per_s2 +
                     limit.drag_kg_per_s / body.mass_kg * (speed + wind_m_per_s);
  // a t^2 / 2, and as much again: within a step, Bullet's place is ahead of the body's.
  return speed * time_s + now / (1 - growth) * time_s * time_s;
}

/// By which angle it turns at most (rad).
double MaxTurn(const Motion& state, const SweptBody& body, const PushLimit& limit, double time_s) {
  // dw/dt <= tau / J_min + c w^2, c = J_max / J_min, by the gyroscopic term. If t c 2 w0 <= 1/2 with w0 = |w| + t tau /
  // J_min, the rate stays below 2 w0: at that rate it would grow by t c (2 w0)^2 <= w0.
  const double without = state.w_WB_B.norm() + time_s * limit.torque_nm / body.min_inertia_kg_m2;
  const double ratio = body.max_inertia_kg_m2 / body.min_inertia_kg_m2;
  return time_s * ratio * 2 * without <= 0.5 ? 2 * without * time_s : kUnlimited;
}

}  // namespace

SweptBody MakeSweptBody(const Model& model, double gravity_m_per_s2, double reach_m) {
  const Eigen::Vector3d inertia = model.inertia_kg_m2();
  const bool is_ball = model.half_size_m().isZero();
  const Eigen::Vector3d half_m = is_ball ? Eigen::Vector3d::Constant(kBallRadius_m) : model.half_size_m();
  return {.mass_kg = model.mass_kg(),
          .min_inertia_kg_m2 = inertia.minCoeff(),
          .max_inertia_kg_m2 = inertia.maxCoeff(),
          .half_size_m = half_m,
          .radius_m = is_ball ? kBallRadius_m : half_m.norm(),
          .gravity_m_per_s2 = model.feels_gravity() ? gravity_m_per_s2 : 0,
          .reach_m = reach_m};
}

Clearance::Box SweptBox(const Motion& state, const SweptBody& body, const PushLimit& limit, double wind_m_per_s,
                        double time_s) {
  constexpr double kRounding_m = 1e-6;
  const Eigen::Vector3d now_m = state.q_WB.toRotationMatrix().cwiseAbs() * body.half_size_m;
  const double turned_m = MaxTurn(state, body, limit, time_s) * body.radius_m;
  const double way_m = MaxWay(state, body, limit, wind_m_per_s, time_s) + body.reach_m + kRounding_m;
  const Eigen::Array3d around_m = (now_m.array() + turned_m).min(body.radius_m) + way_m;
  return {state.p_WB.array() - around_m, state.p_WB.array() + around_m};
}

}  // namespace mascot
