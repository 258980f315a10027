#include "physics_server/bullet/body_in_lanes.h"

#include "physics_server/bullet/conversions.h"

namespace mascot {
namespace {

/// Places of a body's numbers in RotorBodies.
using F = RotorField;

void PutVector(const btVector3& v, RotorBodies& bodies, std::size_t i, int field) {
  for (int k = 0; k < 3; ++k) bodies.At(i, field + k) = v[k];
}
btVector3 VectorAt(const RotorBodies& bodies, std::size_t i, int field) {
  return {bodies.At(i, field), bodies.At(i, field + 1), bodies.At(i, field + 2)};
}

}  // namespace

void PutConstants(const Body& body, double dt_s, double gravity_m_per_s2, RotorBodies& bodies, std::size_t i) {
  const Rotors& rotors = *body.model->rotors();
  for (int row = 0; row < 4; ++row)
    for (int k = 0; k < 4; ++k) bodies.At(i, F::kAllocation + 4 * row + k) = rotors.allocation(row, k);
  bodies.At(i, F::kMaxRotorSpeed) = rotors.max_speed_rad_per_s;
  bodies.At(i, F::kFollowed) = rotors.Followed(dt_s);
  bodies.At(i, F::kDrag) = rotors.drag_kg_per_s;
  bodies.At(i, F::kInverseMass) = body.rigid->getInvMass();
  bodies.At(i, F::kWeight) = -gravity_m_per_s2 * (1 / body.rigid->getInvMass());  // as btRigidBody::setGravity
  PutVector(body.rigid->getLocalInertia(), bodies, i, F::kInertia);
  PutVector(body.rigid->getInvInertiaDiagLocal(), bodies, i, F::kInverseInertia);
}

void MoveOutOfBullet(Body& body, RotorBodies& bodies, std::size_t i) {
  const btTransform& X_WB = body.rigid->getWorldTransform();
  PutVector(X_WB.getOrigin(), bodies, i, F::kP);
  for (int row = 0; row < 3; ++row) PutVector(X_WB.getBasis()[row], bodies, i, F::kR + 3 * row);
  PutVector(body.rigid->getLinearVelocity(), bodies, i, F::kV);
  PutVector(body.rigid->getAngularVelocity(), bodies, i, F::kW);
  for (int k = 0; k < 4; ++k) bodies.At(i, F::kRotors + k) = body.model->rotors()->speed_rad_per_s[k];
}
void MoveIntoBullet(const RotorBodies& bodies, std::size_t i, Body& body) {
  btMatrix3x3 R_WB;
  for (int row = 0; row < 3; ++row) R_WB[row] = VectorAt(bodies, i, F::kR + 3 * row);
  body.rigid->setLinearVelocity(VectorAt(bodies, i, F::kV));
  body.rigid->setAngularVelocity(VectorAt(bodies, i, F::kW));
  body.rigid->proceedToTransform(btTransform(R_WB, VectorAt(bodies, i, F::kP)));
  for (int k = 0; k < 4; ++k) body.model->rotors()->speed_rad_per_s[k] = bodies.At(i, F::kRotors + k);
}

Motion Now(const RotorBodies& bodies, std::size_t i) {
  Motion now;
  now.p_WB = ToEigen(VectorAt(bodies, i, F::kP));
  for (int k = 0; k < 4; ++k) now.q_WB.coeffs()[k] = bodies.At(i, F::kQ + k);
  now.v_WB = ToEigen(VectorAt(bodies, i, F::kV));
  now.w_WB_B = ToEigen(VectorAt(bodies, i, F::kWInB));
  return now;
}

}  // namespace mascot
