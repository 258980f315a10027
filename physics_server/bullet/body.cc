// Bullet integrates semi-implicitly: v+ = v + dt a, p+ = p + dt v+, which puts p ahead by dt/2 * (v - v(0)). We take
// back dt/2 (v+ - v) after each step. That is the trapezoidal rule: exact for a constant force, and no change for a
// body that rests on the ground. The gyroscopic term is Bullet's implicit one (on by default for a rigid body);
// rotation is first order in dt. Bullet turns a body by at most pi/4 in a step: 785 rad/s at 1 kHz.
//
// A body driven by velocity has no acceleration to correct for: p+ = p + dt v is what its model asks for.
#include "physics_server/bullet/body.h"

#include <algorithm>

#include "physics_server/bullet/conversions.h"

namespace mascot {
namespace {

btTransform Upright(const Eigen::Vector3d& p_W, double heading_rad) {
  return btTransform(btQuaternion(btVector3(0, 0, 1), heading_rad), ToBullet(p_W));
}

std::unique_ptr<btCollisionShape> MakeShape(const Model& model) {
  if (model.half_size_m().isZero()) return std::make_unique<btSphereShape>(kBallRadius_m);
  return std::make_unique<btBoxShape>(ToBullet(model.half_size_m()));
}

BodyNow AtStep(const btRigidBody& rigid) {
  return {ToEigen(rigid.getWorldTransform().getBasis()), ToEigen(rigid.getLinearVelocity())};
}

}  // namespace

double ReachOfContacts_m(const btCollisionShape& shape) {
  return std::max(gContactBreakingThreshold, shape.getContactBreakingThreshold(gContactBreakingThreshold));
}

Body MakeBody(const Experiment& experiment, const AgentConfig& agent) {
  Body body;
  body.model = MakeModel(experiment, agent.id);
  body.shape = MakeShape(*body.model);
  btRigidBody::btRigidBodyConstructionInfo info(body.model->mass_kg(), nullptr, body.shape.get(),
                                                ToBullet(body.model->inertia_kg_m2()));
  info.m_startWorldTransform = Upright(agent.p_W, agent.heading_rad);
  body.rigid = std::make_unique<btRigidBody>(info);
  body.rigid->setLinearVelocity(ToBullet(agent.v_W));
  body.rigid->setDamping(0, 0);
  body.rigid->setActivationState(DISABLE_DEACTIVATION);
  body.rigid->setUserIndex(agent.id);
  body.reach_of_contacts_m = ReachOfContacts_m(*body.shape);
  body.swept = MakeSweptBody(*body.model, experiment.physics.gravity_m_per_s2, body.reach_of_contacts_m);
  if (body.model->feels_gravity())
    body.rigid->setGravity({0, 0, -experiment.physics.gravity_m_per_s2});
  else
    body.rigid->setFlags(body.rigid->getFlags() | BT_DISABLE_WORLD_GRAVITY);
  if (!body.model->touches_ground()) {
    body.rigid->setLinearFactor({1, 1, 0});
    body.rigid->setAngularFactor({0, 0, 1});
  }
  body.state.p_WB = agent.p_W;
  body.state.q_WB = Eigen::AngleAxisd(agent.heading_rad, Eigen::Vector3d::UnitZ());
  body.state.v_WB = agent.v_W;
  return body;
}

Motion Now(const btRigidBody& rigid) {
  const btTransform& X_WB = rigid.getWorldTransform();
  Motion now;
  now.p_WB = ToEigen(X_WB.getOrigin());
  now.q_WB = ToEigen(X_WB.getRotation());
  now.v_WB = ToEigen(rigid.getLinearVelocity());
  now.w_WB_B = ToEigen(rigid.getAngularVelocity() * X_WB.getBasis());  // v * M is M^T v
  return now;
}

Clearance::Box BoxAround(const Body& body) { return BoxAround(*body.rigid, body.reach_of_contacts_m); }

Clearance::Box BoxAround(const btRigidBody& rigid, double reach_m) {
  btVector3 low, high;
  rigid.getAabb(low, high);
  return {ToEigen(low).array() - reach_m, ToEigen(high).array() + reach_m};
}

void PushBody(Body& body, const Actuation& command, const Surroundings& around) {
  const Push push = body.model->Apply(command, AtStep(*body.rigid), around);
  const btMatrix3x3& R_WB = body.rigid->getWorldTransform().getBasis();
  body.driven_by_velocity = push.velocity.has_value();
  if (push.velocity) {
    body.rigid->setLinearVelocity(ToBullet(push.velocity->v_W));
    body.rigid->setAngularVelocity(R_WB * ToBullet(push.velocity->w_B));
  }
  body.rigid->applyCentralForce(ToBullet(push.f_W));
  body.rigid->applyTorque(R_WB * ToBullet(push.tau_B));
  body.v_before_W = body.rigid->getLinearVelocity();
}

void StepFreely(Body& body, double dt_s) {
  btRigidBody& rigid = *body.rigid;
  const btVector3 of_contacts(0, 0, 0);  // the solver adds this, too: -0 + 0 is 0
  rigid.applyGravity();
  const btVector3 dv_W = rigid.getTotalForce() * rigid.getInvMass() * dt_s;
  btVector3 dw_W = rigid.getTotalTorque() * rigid.getInvInertiaTensorWorld() * dt_s;
  dw_W += rigid.computeGyroscopicImpulseImplicit_Body(dt_s);
  rigid.setLinearVelocity(rigid.getLinearVelocity() + of_contacts + dv_W);
  rigid.setAngularVelocity(rigid.getAngularVelocity() + of_contacts + dw_W);
  btTransform next;
  rigid.predictIntegratedTransform(dt_s, next);
  rigid.proceedToTransform(next);
  rigid.clearForces();
}

void CorrectPlace(Body& body, double dt_s) {
  if (body.driven_by_velocity) return;
  body.rigid->getWorldTransform().getOrigin() -= (dt_s / 2) * (body.rigid->getLinearVelocity() - body.v_before_W);
}

}  // namespace mascot
