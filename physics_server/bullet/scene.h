#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "experiment/experiment.h"
#include "physics_server/bullet/body.h"
#include "physics_server/clearance.h"

namespace mascot {

/// The Bullet world: the ground, the obstacles, and those bodies that are in it now. What it does with them depends
/// neither on when they came nor on which others are in it, as long as these do not touch them.
class Scene {
 public:
  explicit Scene(const Experiment& experiment);
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// Adds a body, which must outlive the scene, or be removed.
  void Add(Body& body);
  /// Removes a body that touches nothing.
  void Remove(Body& body) { world_.removeRigidBody(body.rigid.get()); }
  /// Flies all bodies that were added through one step.
  void Step(double dt_s) { world_.stepSimulation(dt_s, 0); }
  btDispatcher& dispatcher() { return dispatcher_; }
  /// Around each obstacle, outside of which it makes no contact points.
  std::vector<Clearance::Box> BoxesOfObstacles() const;

 private:
  /// The plane z = 0, solid below. Its bounding box ends there, so that bodies in the air are not paired with it.
  class Ground final : public btStaticPlaneShape {
   public:
    Ground() : btStaticPlaneShape(btVector3(0, 0, 1), 0) {}
    void getAabb(const btTransform& pose, btVector3& low, btVector3& high) const override;
  };
  struct FixedBody {
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btRigidBody> rigid;
  };
  /// Bullet's pools of contacts take 4 MB, which it clears at the start; it allocates what a pool does not have.
  static btDefaultCollisionConstructionInfo SmallPools();
  static FixedBody MakeFixed(const Obstacle& obstacle, int user_index);

  bool do_agents_collide_;
  // Bodies must outlive the world that holds them, so they come first.
  Ground ground_shape_;
  btRigidBody ground_{0, nullptr, &ground_shape_};
  std::vector<FixedBody> obstacles_;
  btDefaultCollisionConfiguration collision_{SmallPools()};
  btCollisionDispatcher dispatcher_{&collision_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &collision_};
};

}  // namespace mascot
