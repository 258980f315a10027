// The only file that includes Bullet; built with BT_USE_DOUBLE_PRECISION.
//
// Bullet integrates semi-implicitly: v+ = v + dt a, p+ = p + dt v+, which puts p ahead by dt/2 * (v - v(0)). We take
// back dt/2 (v+ - v) after each step, the trapezoidal rule: exact for a constant force, and no change for a body that
// rests on the ground. The gyroscopic term is Bullet's implicit one (on by default for a rigid body); turning is first
// order in dt. Bullet turns a body by at most pi/4 in a step: 785 rad/s at 1 kHz.
#include "physics_server/world.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "physics_server/model.h"

namespace mascot {
namespace {

constexpr double kSphereRadius_m = 0.1;
constexpr int kGroundIndex = 0;  // Bullet's user index of the ground; agents have their id.
enum CollisionGroup { kGround = 1, kAgents = 2 };

btVector3 ToBullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d ToEigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
// Bullet's quaternions are x, y, z, w; the constructor of Eigen's takes w, x, y, z.
Eigen::Quaterniond ToEigen(const btQuaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }

/// The plane z = 0, solid below. Its bounding box ends there, so that bodies in the air are not paired with it.
class Ground final : public btStaticPlaneShape {
 public:
  Ground() : btStaticPlaneShape(btVector3(0, 0, 1), 0) {}
  void getAabb(const btTransform& /*pose*/, btVector3& low, btVector3& high) const override {
    low = btVector3(-BT_LARGE_FLOAT, -BT_LARGE_FLOAT, -BT_LARGE_FLOAT);
    high = btVector3(BT_LARGE_FLOAT, BT_LARGE_FLOAT, 0);
  }
};

struct Body {
  std::unique_ptr<Model> model;
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> rigid;
  Motion state;          // at the current tick
  btVector3 v_before_W;  // before the running step
};

std::unique_ptr<btCollisionShape> MakeShape(const Model& model) {
  if (model.half_size_m().isZero()) return std::make_unique<btSphereShape>(kSphereRadius_m);
  return std::make_unique<btBoxShape>(ToBullet(model.half_size_m()));
}

Body MakeBody(const Experiment& experiment, const AgentConfig& agent) {
  Body body;
  body.model = MakeModel(experiment, agent.id);
  body.shape = MakeShape(*body.model);
  btRigidBody::btRigidBodyConstructionInfo info(body.model->mass_kg(), nullptr, body.shape.get(),
                                                ToBullet(body.model->inertia_kg_m2()));
  info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), ToBullet(agent.p_W));
  body.rigid = std::make_unique<btRigidBody>(info);
  body.rigid->setLinearVelocity(ToBullet(agent.v_W));
  body.rigid->setDamping(0, 0);
  body.rigid->setActivationState(DISABLE_DEACTIVATION);
  body.rigid->setUserIndex(agent.id);
  if (!body.model->feels_gravity()) body.rigid->setFlags(body.rigid->getFlags() | BT_DISABLE_WORLD_GRAVITY);
  body.state.p_WB = agent.p_W;
  body.state.v_WB = agent.v_W;
  return body;
}

/// What Bullet knows of a body now. a_WB is left at 0: it belongs to ticks, not to steps.
Motion Now(const btRigidBody& rigid) {
  const btTransform& X_WB = rigid.getWorldTransform();
  Motion now;
  now.p_WB = ToEigen(X_WB.getOrigin());
  now.q_WB = ToEigen(X_WB.getRotation());
  now.v_WB = ToEigen(rigid.getLinearVelocity());
  now.w_WB_B = ToEigen(rigid.getAngularVelocity() * X_WB.getBasis());  // v * M is M^T v
  return now;
}

bool IsFinite(const Motion& motion) {
  return motion.p_WB.allFinite() && motion.v_WB.allFinite() && motion.q_WB.coeffs().allFinite() &&
         motion.w_WB_B.allFinite();
}

std::string At(std::int64_t tick, std::size_t index) {
  return "tick " + std::to_string(tick) + ": agent " + std::to_string(index + 1) + ": ";
}

void CheckFinite(std::span<const Actuation> commands, std::int64_t tick) {
  for (std::size_t i = 0; i < commands.size(); ++i)
    for (std::size_t j = 0; j < commands[i].size(); ++j)
      if (const double value = commands[i][j]; !std::isfinite(value))
        throw std::runtime_error(At(tick, i) + "actuator[" + std::to_string(j) + "] is " +
                                 (std::isnan(value) ? "nan"
                                  : value > 0       ? "inf"
                                                    : "-inf"));
}

/// Counts the contacts that begin. A contact begins when two surfaces touch, and ends when Bullet drops all its points,
/// some millimetres apart (20 at most): so resting, sliding and rattling count once.
class ContactCounter {
 public:
  void Look(btDispatcher& dispatcher) {
    now_.clear();
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      if (manifold.getNumContacts() == 0) continue;
      const Pair pair = std::minmax(manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex());
      const bool lasts = std::ranges::binary_search(lasting_, pair);
      if (!lasts && !Touches(manifold)) continue;
      now_.push_back(pair);
      if (!lasts) ++begun_;
    }
    std::ranges::sort(now_);
    lasting_.swap(now_);
  }
  std::int64_t begun() const { return begun_; }

 private:
  using Pair = std::pair<int, int>;

  static bool Touches(const btPersistentManifold& manifold) {
    for (int i = 0; i < manifold.getNumContacts(); ++i)
      if (manifold.getContactPoint(i).getDistance() <= 0) return true;
    return false;
  }

  std::vector<Pair> lasting_, now_;  // sorted; two buffers, so that a step allocates nothing
  std::int64_t begun_ = 0;
};

}  // namespace

struct World::Impl {
  explicit Impl(const Experiment& experiment);
  void Step(std::span<const Actuation> commands);
  void EndTick();

  double dt_s;
  double control_rate_hz;
  int steps_per_tick;
  std::int64_t tick = 0;
  ContactCounter contacts;

  // Bodies outlive the world that holds them, so they come first.
  Ground ground_shape;
  btRigidBody ground{0, nullptr, &ground_shape};
  std::vector<Body> bodies;
  btDefaultCollisionConfiguration collision;
  btCollisionDispatcher dispatcher{&collision};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &collision};
};

World::Impl::Impl(const Experiment& experiment)
    : dt_s(1.0 / experiment.physics.rate_hz),
      control_rate_hz(experiment.control.rate_hz),
      steps_per_tick(experiment.steps_per_tick()) {
  collision.setPlaneConvexMultipointIterations();  // a box then stands on four points at once
  world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;  // overlap is pushed apart without giving it speed
  world.setForceUpdateAllAabbs(false);
  world.setGravity({0, 0, -experiment.physics.gravity_m_per_s2});
  ground.setUserIndex(kGroundIndex);
  if (experiment.physics.ground) world.addRigidBody(&ground, kGround, kAgents);
  bodies.reserve(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) {
    bodies.push_back(MakeBody(experiment, agent));
    world.addRigidBody(bodies.back().rigid.get(), kAgents, experiment.physics.collisions ? kGround | kAgents : kGround);
  }
}

void World::Impl::Step(std::span<const Actuation> commands) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    const Wrench wrench = body.model->Apply(commands[i], Now(*body.rigid), dt_s);
    body.rigid->applyCentralForce(ToBullet(wrench.f_W));
    body.rigid->applyTorque(body.rigid->getWorldTransform().getBasis() * ToBullet(wrench.tau_B));
    body.v_before_W = body.rigid->getLinearVelocity();
  }
  world.stepSimulation(dt_s, 0);
  for (Body& body : bodies)
    body.rigid->getWorldTransform().getOrigin() -= (dt_s / 2) * (body.rigid->getLinearVelocity() - body.v_before_W);
  contacts.Look(dispatcher);
}

void World::Impl::EndTick() {
  ++tick;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Motion now = Now(*bodies[i].rigid);
    Motion& state = bodies[i].state;
    if (!IsFinite(now)) throw std::runtime_error(At(tick, i) + "its state is not finite");
    if (now.q_WB.dot(state.q_WB) < 0) now.q_WB.coeffs() *= -1;  // q and -q turn alike; the nearer one is continuous
    now.a_WB = (now.v_WB - state.v_WB) * control_rate_hz;
    state = now;
  }
}

World::World(const Experiment& experiment) : impl_(std::make_unique<Impl>(experiment)) {}
World::~World() = default;

Motion World::State(int id) const { return impl_->bodies[static_cast<std::size_t>(id - 1)].state; }

void World::Step(std::span<const Actuation> commands) {
  if (commands.size() != impl_->bodies.size()) throw std::invalid_argument("World::Step: one command per agent");
  CheckFinite(commands, impl_->tick);
  for (int i = 0; i < impl_->steps_per_tick; ++i) impl_->Step(commands);
  impl_->EndTick();
}

std::int64_t World::tick() const { return impl_->tick; }

std::int64_t World::collisions() const { return impl_->contacts.begun(); }

}  // namespace mascot
