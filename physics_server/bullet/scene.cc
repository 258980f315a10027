#include "physics_server/bullet/scene.h"

#include <stdexcept>

#include "physics_server/bullet/contact_counter.h"
#include "physics_server/bullet/conversions.h"

namespace mascot {
namespace {

enum CollisionGroup { kGround = 1, kAgents = 2, kObstacles = 4 };

std::unique_ptr<btCollisionShape> MakeShape(const Obstacle& obstacle) {
  const btVector3 half_m = ToBullet(obstacle.size_m / 2);
  switch (obstacle.shape) {
    case Shape::kBox:
      return std::make_unique<btBoxShape>(half_m);
    case Shape::kSphere:
      return std::make_unique<btSphereShape>(half_m.x());
    case Shape::kCylinder:
      return std::make_unique<btCylinderShapeZ>(half_m);
  }
  throw std::invalid_argument("no such shape");
}

}  // namespace

void Scene::Ground::getAabb(const btTransform& /*pose*/, btVector3& low, btVector3& high) const {
  low = btVector3(-BT_LARGE_FLOAT, -BT_LARGE_FLOAT, -BT_LARGE_FLOAT);
  high = btVector3(BT_LARGE_FLOAT, BT_LARGE_FLOAT, 0);
}

Scene::FixedBody Scene::MakeFixed(const Obstacle& obstacle, int user_index) {
  FixedBody body;
  body.shape = MakeShape(obstacle);
  body.rigid = std::make_unique<btRigidBody>(0, nullptr, body.shape.get());
  body.rigid->setWorldTransform(Upright(obstacle.p_W, obstacle.heading_rad));
  body.rigid->setUserIndex(user_index);
  return body;
}

btDefaultCollisionConstructionInfo Scene::SmallPools() {
  btDefaultCollisionConstructionInfo info;
  info.m_defaultMaxPersistentManifoldPoolSize = 64;
  info.m_defaultMaxCollisionAlgorithmPoolSize = 64;
  return info;
}

Scene::Scene(const Experiment& experiment) : do_agents_collide_(experiment.physics.collisions) {
  collision_.setPlaneConvexMultipointIterations();  // a box then stands on four points at once
  // Bullet's own algorithm for two spheres drops a contact as soon as they are apart: spheres that slide along each
  // other would count again and again.
  dispatcher_.registerCollisionCreateFunc(
      SPHERE_SHAPE_PROXYTYPE, SPHERE_SHAPE_PROXYTYPE,
      collision_.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE));
  world_.getDispatchInfo().m_deterministicOverlappingPairs = true;
  world_.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;  // overlap is pushed apart without giving it speed
  world_.setForceUpdateAllAabbs(false);
  world_.setGravity({0, 0, -experiment.physics.gravity_m_per_s2});
  ground_.setUserIndex(kGroundIndex);
  if (experiment.physics.ground) world_.addRigidBody(&ground_, kGround, kAgents);
  for (const Obstacle& obstacle : experiment.physics.obstacles) {
    obstacles_.push_back(MakeFixed(obstacle, kObstacleIndex - static_cast<int>(obstacles_.size())));
    world_.addRigidBody(obstacles_.back().rigid.get(), kObstacles, kAgents);
  }
}

void Scene::Add(Body& body) {
  // Bullet numbers bodies as they come, and takes pairs in the order of these numbers.
  broadphase_.m_gid = 1 + static_cast<int>(obstacles_.size()) + body.rigid->getUserIndex() - 1;
  const int ground_if_touched = body.model->touches_ground() ? kGround : 0;
  world_.addRigidBody(body.rigid.get(), kAgents, ground_if_touched | (do_agents_collide_ ? kAgents | kObstacles : 0));
}

std::vector<Clearance::Box> Scene::BoxesOfObstacles() const {
  std::vector<Clearance::Box> boxes;
  for (const FixedBody& obstacle : obstacles_)
    boxes.push_back(BoxAround(*obstacle.rigid, ReachOfContacts_m(*obstacle.shape)));
  return boxes;
}

}  // namespace mascot
