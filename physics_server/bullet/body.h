#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include "base/motion.h"
#include "experiment/experiment.h"
#include "physics_server/clearance.h"
#include "physics_server/model.h"
#include "physics_server/swept_box.h"

namespace mascot {

/// The body of an agent in Bullet.
struct Body {
  std::unique_ptr<Model> model;
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> rigid;
  Motion state;          ///< at the current tick
  btVector3 v_before_W;  ///< at the start of the running step
  bool driven_by_velocity = false;
  double reach_of_contacts_m = 0;
  SweptBody swept;
};

Body MakeBody(const Experiment& experiment, const AgentConfig& agent);

/// The motion of a body in Bullet now. a_WB is left at 0: it is defined by ticks, not by steps.
Motion Now(const btRigidBody& rigid);

/// Largest distance of two surfaces at which Bullet may make a contact point of them, as far as `shape` decides (m).
double ReachOfContacts_m(const btCollisionShape& shape);

/// The body's bounding box, with `reach_m` added on every side: outside of it the body gets no contact point.
Clearance::Box BoxAround(const btRigidBody& rigid, double reach_m);
Clearance::Box BoxAround(const Body& body);  ///< by its own reach

/// Begins a step: the body's model pushes it, as `command` says.
void PushBody(Body& body, const Actuation& command, const Surroundings& around);

/// One step of a body that touches nothing: gravity, forces, torques, the gyroscopic term, then the move, in the order
/// and with the rounding errors of btDiscreteDynamicsWorld and its solver.
void StepFreely(Body& body, double dt_s);

/// Ends a step: takes back what Bullet puts the body ahead by.
void CorrectPlace(Body& body, double dt_s);

}  // namespace mascot
