#pragma once

// Bodies with rotors that touch nothing, several at once: one step is Quadrotor::Apply (physics_server/models), then
// StepFreely and the correction of the place (physics_server/bullet/body.cc), with Bullet's operations in Bullet's
// order, so that the bits are the same. To be included by sources that are compiled for lanes (base/lanes.h).
#include <cstddef>
#include <numbers>

#include "base/lanes.h"
#include "physics_server/lanes/rotor_bodies.h"

namespace mascot {
namespace {  // NOLINT(google-build-namespaces): as in base/lanes.h

struct Vector {
  Real x, y, z;
};
struct Rotation {
  Real x, y, z, w;
};
struct Matrix {
  Vector row[3];
};

MASCOT_IN_LANES Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
MASCOT_IN_LANES Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
MASCOT_IN_LANES Vector operator*(const Vector& a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
MASCOT_IN_LANES Real Dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
MASCOT_IN_LANES Vector Cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
MASCOT_IN_LANES Vector operator*(const Matrix& m, const Vector& v) {
  return {Dot(m.row[0], v), Dot(m.row[1], v), Dot(m.row[2], v)};
}
/// m^T v.
MASCOT_IN_LANES Vector operator*(const Vector& v, const Matrix& m) {
  return {m.row[0].x * v.x + m.row[1].x * v.y + m.row[2].x * v.z,
          m.row[0].y * v.x + m.row[1].y * v.y + m.row[2].y * v.z,
          m.row[0].z * v.x + m.row[1].z * v.y + m.row[2].z * v.z};
}
MASCOT_IN_LANES Rotation operator*(const Rotation& p, const Rotation& q) {
  return {p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y, p.w * q.y + p.y * q.w + p.z * q.x - p.x * q.z,
          p.w * q.z + p.z * q.w + p.x * q.y - p.y * q.x, p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z};
}
MASCOT_IN_LANES Rotation operator*(const Rotation& q, const Vector& v) {
  return {q.w * v.x + q.y * v.z - q.z * v.y, q.w * v.y + q.z * v.x - q.x * v.z, q.w * v.z + q.x * v.y - q.y * v.x,
          -q.x * v.x - q.y * v.y - q.z * v.z};
}
MASCOT_IN_LANES Rotation Inverse(const Rotation& q) { return {-q.x, -q.y, -q.z, q.w}; }
MASCOT_IN_LANES Real Dot(const Rotation& a, const Rotation& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
MASCOT_IN_LANES Vector Rotated(const Vector& v, const Rotation& q) {
  const Rotation r = q * v * Inverse(q);
  return {r.x, r.y, r.z};
}

/// btMatrix3x3::getRotation of one lane.
inline void RotationOfOne(const double (&m)[3][3], double (&q)[4]) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    double s = __builtin_sqrt(trace + 1);
    q[3] = s * 0.5;
    s = 0.5 / s;
    q[0] = (m[2][1] - m[1][2]) * s;
    q[1] = (m[0][2] - m[2][0]) * s;
    q[2] = (m[1][0] - m[0][1]) * s;
    return;
  }
  const int i = m[0][0] < m[1][1] ? (m[1][1] < m[2][2] ? 2 : 1) : (m[0][0] < m[2][2] ? 2 : 0);
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  double s = __builtin_sqrt(m[i][i] - m[j][j] - m[k][k] + 1);
  q[i] = s * 0.5;
  s = 0.5 / s;
  q[3] = (m[k][j] - m[j][k]) * s;
  q[j] = (m[j][i] + m[i][j]) * s;
  q[k] = (m[k][i] + m[i][k]) * s;
}

/// btMatrix3x3::getRotation. Nearly always all bodies turn by less than 120 degrees.
MASCOT_IN_LANES Rotation RotationOf(const Matrix& m) {
  const Real trace = m.row[0].x + m.row[1].y + m.row[2].z;
  if (AllOf(trace > 0)) {
    const Real root = Sqrt(trace + 1.0), s = 0.5 / root;
    return {(m.row[2].y - m.row[1].z) * s, (m.row[0].z - m.row[2].x) * s, (m.row[1].x - m.row[0].y) * s, root * 0.5};
  }
  Rotation all;
  for (std::ptrdiff_t lane = 0; lane < kLanes; ++lane) {
    double one[3][3], q[4];
    for (int r = 0; r < 3; ++r) {
      one[r][0] = m.row[r].x[lane];
      one[r][1] = m.row[r].y[lane];
      one[r][2] = m.row[r].z[lane];
    }
    RotationOfOne(one, q);
    all.x[lane] = q[0];
    all.y[lane] = q[1];
    all.z[lane] = q[2];
    all.w[lane] = q[3];
  }
  return all;
}

/// btMatrix3x3::setRotation.
MASCOT_IN_LANES Matrix MatrixOf(const Rotation& q) {
  const Real s = 2.0 / Dot(q, q);
  const Real xs = q.x * s, ys = q.y * s, zs = q.z * s;
  const Real wx = q.w * xs, wy = q.w * ys, wz = q.w * zs;
  const Real xx = q.x * xs, xy = q.x * ys, xz = q.x * zs, yy = q.y * ys, yz = q.y * zs, zz = q.z * zs;
  return {
      {{1.0 - (yy + zz), xy - wz, xz + wy}, {xy + wz, 1.0 - (xx + zz), yz - wx}, {xz - wy, yz + wx, 1.0 - (xx + yy)}}};
}

constexpr double kEpsilon = 2.2204460492503131e-16;  // SIMD_EPSILON
constexpr double kMaxTurn = std::numbers::pi / 4;    // ANGULAR_MOTION_THRESHOLD: in one step

/// The rates that torques about the axes of W give in dt: btRigidBody's inverse inertia in W, times the torque.
MASCOT_IN_LANES Vector TurnedBy(const Vector& tau_W, const Matrix& R, const Vector& inverse_inertia) {
  Matrix scaled, inverse_W;
  for (int r = 0; r < 3; ++r)
    scaled.row[r] = {R.row[r].x * inverse_inertia.x, R.row[r].y * inverse_inertia.y, R.row[r].z * inverse_inertia.z};
  for (int r = 0; r < 3; ++r)
    inverse_W.row[r] = {Dot(R.row[0], scaled.row[r]), Dot(R.row[1], scaled.row[r]), Dot(R.row[2], scaled.row[r])};
  return tau_W * inverse_W;
}

/// btRigidBody::computeGyroscopicImpulseImplicit_Body.
MASCOT_IN_LANES Vector Gyroscopic(const Vector& w_W, const Rotation& q, const Vector& inertia, Real dt) {
  const Real zero = {};
  Vector w_B = Rotated(w_W, Inverse(q));
  const Vector L{inertia.x * w_B.x + zero * w_B.y + zero * w_B.z, zero * w_B.x + inertia.y * w_B.y + zero * w_B.z,
                 zero * w_B.x + zero * w_B.y + inertia.z * w_B.z};
  const Vector f = Cross(w_B, L) * dt;
  const Matrix diagonal{{{inertia.x, zero, zero}, {zero, inertia.y, zero}, {zero, zero, inertia.z}}};
  const Matrix of_w{{{zero, -w_B.z, w_B.y}, {w_B.z, zero, -w_B.x}, {-w_B.y, w_B.x, zero}}};
  const Matrix of_L{{{zero, -L.z, L.y}, {L.z, zero, -L.x}, {-L.y, L.x, zero}}};
  Matrix J;
  for (int r = 0; r < 3; ++r) J.row[r] = diagonal.row[r] + (of_w.row[r] * diagonal - of_L.row[r]) * dt;
  const Vector c1{J.row[0].x, J.row[1].x, J.row[2].x}, c2{J.row[0].y, J.row[1].y, J.row[2].y},
      c3{J.row[0].z, J.row[1].z, J.row[2].z};  // btMatrix3x3::solve33
  Real det = Dot(c1, Cross(c2, c3));
  det = Abs(det) > kEpsilon ? 1.0 / det : det;
  const Vector x{det * Dot(f, Cross(c2, c3)), det * Dot(c1, Cross(f, c3)), det * Dot(c1, Cross(c2, f))};
  return Rotated(w_B - x, q) - w_W;
}

/// The rotational part of btTransformUtil::integrateTransform.
MASCOT_IN_LANES Matrix Turned(const Rotation& q, const Vector& w, double dt) {
  const Real square = Dot(w, w);
  Real rate = square > kEpsilon ? Sqrt(square) : Real{};
  rate = rate * dt > kMaxTurn ? InEach(kMaxTurn / dt) : rate;
  const Real series = 0.5 * dt - (dt * dt * dt) * 0.020833333333 * rate * rate;
  const Mask is_slow = rate < 0.001;
  Real k = series;
  if (!AllOf(is_slow)) k = is_slow ? series : Sin(0.5 * rate * dt) / rate;
  const Rotation turn{w.x * k, w.y * k, w.z * k, Cos(rate * dt * 0.5)};
  Rotation next = turn * q;
  const Real inverse = 1.0 / Sqrt(Dot(next, next));
  next = {next.x * inverse, next.y * inverse, next.z * inverse, next.w * inverse};
  return MatrixOf(next);
}

MASCOT_IN_LANES Vector GetVector(const Block& block, int field) {
  return {block.Get(field), block.Get(field + 1), block.Get(field + 2)};
}
MASCOT_IN_LANES void SetVector(const Block& block, int field, const Vector& v) {
  block.Set(field, v.x);
  block.Set(field + 1, v.y);
  block.Set(field + 2, v.z);
}

/// Flies one block of bodies through a tick.
MASCOT_IN_LANES void FlyBlock(const Block& block, const TickOfRotorBodies& tick) {
  using F = RotorField;
  const double dt = tick.dt_s;
  const Real zero = {};
  Vector p = GetVector(block, F::kP), v = GetVector(block, F::kV), w = GetVector(block, F::kW);
  Matrix R{{GetVector(block, F::kR), GetVector(block, F::kR + 3), GetVector(block, F::kR + 6)}};
  Real rotor[4], wanted[4], remaining[4], allocation[4][4];
  for (int k = 0; k < 4; ++k) {
    rotor[k] = block.Get(F::kRotors + k);
    wanted[k] = Min(Max(block.Get(F::kCommand + k), zero), block.Get(F::kMaxRotorSpeed));
    remaining[k] = block.Get(F::kRemaining + k);
    for (int i = 0; i < 4; ++i) allocation[i][k] = block.Get(F::kAllocation + 4 * i + k);
  }
  const Real followed = block.Get(F::kFollowed), minus_drag = -block.Get(F::kDrag);
  const Real inverse_mass = block.Get(F::kInverseMass), weight = block.Get(F::kWeight);
  const Vector inertia = GetVector(block, F::kInertia), inverse_inertia = GetVector(block, F::kInverseInertia);

  for (const std::array<double, 3>& wind : tick.wind_W) {
    Real squared[4], wrench[4];
    for (int k = 0; k < 4; ++k) {
      rotor[k] = rotor[k] + followed * (wanted[k] - rotor[k]);
      squared[k] = remaining[k] * (rotor[k] * rotor[k]);
    }
    for (int i = 0; i < 4; ++i)
      wrench[i] = allocation[i][0] * squared[0] + allocation[i][1] * squared[1] + allocation[i][2] * squared[2] +
                  allocation[i][3] * squared[3];
    const Vector drag{minus_drag * (v.x - wind[0]), minus_drag * (v.y - wind[1]), minus_drag * (v.z - wind[2])};
    const Vector push{wrench[0] * R.row[0].z + drag.x, wrench[0] * R.row[1].z + drag.y,
                      wrench[0] * R.row[2].z + drag.z};
    const Vector none{zero, zero, zero};  // what Bullet begins its sums with, and what contacts add: -0 + 0 is 0
    const Vector force = none + push + Vector{zero, zero, weight};
    const Vector torque = none + R * Vector{wrench[1], wrench[2], wrench[3]};
    const Rotation q = RotationOf(R);
    const Vector v_before = v;
    const Vector dv = force * inverse_mass * InEach(dt);
    const Vector dw = TurnedBy(torque, R, inverse_inertia) * InEach(dt) + Gyroscopic(w, q, inertia, InEach(dt));
    v = v + none + dv;
    w = w + none + dw;
    p = p + v * InEach(dt);
    R = Turned(q, w, dt);
    p = p - (v - v_before) * InEach(dt / 2);
  }

  for (int k = 0; k < 4; ++k) block.Set(F::kRotors + k, rotor[k]);
  SetVector(block, F::kP, p);
  SetVector(block, F::kV, v);
  SetVector(block, F::kW, w);
  for (int r = 0; r < 3; ++r) SetVector(block, F::kR + 3 * r, R.row[r]);
  const Rotation q = RotationOf(R);
  block.Set(F::kQ, q.x);
  block.Set(F::kQ + 1, q.y);
  block.Set(F::kQ + 2, q.z);
  block.Set(F::kQ + 3, q.w);
  SetVector(block, F::kWInB, w * R);
}

/// Flies blocks of bodies through a tick.
void FlyBlocks(double* numbers, std::size_t blocks, const TickOfRotorBodies& tick) {
  for (std::size_t b = 0; b < blocks; ++b) FlyBlock(Block(numbers + b * kLanes * RotorField::kCount), tick);
}

}  // namespace
}  // namespace mascot
