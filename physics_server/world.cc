// The only file that includes Bullet; built with BT_USE_DOUBLE_PRECISION.
//
// Bullet integrates semi-implicitly: v+ = v + dt a, p+ = p + dt v+, which puts p ahead by dt/2 * (v - v(0)). We take
// back dt/2 (v+ - v) after each step. That is the trapezoidal rule: exact for a constant force, and no change for a
// body that rests on the ground. The gyroscopic term is Bullet's implicit one (on by default for a rigid body);
// rotation is first order in dt. Bullet turns a body by at most pi/4 in a step: 785 rad/s at 1 kHz.
//
// A body driven by velocity has no acceleration to correct for: p+ = p + dt v is what its model asks for.
//
// In most steps nothing touches, but Bullet's broadphase, islands and solver still cost most of the step. While the
// boxes around all bodies are apart (Clearance), we move each body by itself, with exactly the operations of a whole
// step, so that the bits are the same: through a whole tick if the boxes that the bodies cannot leave meanwhile
// (SweptBox) are apart, else step by step. In whole ticks, bodies with rotors are flown several at once (RotorBodies),
// which then have their numbers, and Bullet has not.
#include "physics_server/world.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "physics_server/clearance.h"
#include "physics_server/lanes/rotor_bodies.h"
#include "physics_server/model.h"
#include "physics_server/swept_box.h"
#include "physics_server/wind.h"

namespace mascot {
namespace {

// Bullet user indices of bodies that are no agents; an agent has its id.
constexpr int kGroundIndex = Contact::kGround;
constexpr int kObstacleIndex = -1;  // the first obstacle; the next is one less, and so on
enum CollisionGroup { kGround = 1, kAgents = 2, kObstacles = 4 };

btVector3 ToBullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d ToEigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Matrix3d ToEigen(const btMatrix3x3& m) {
  return Eigen::Matrix3d{
      {m[0].x(), m[0].y(), m[0].z()}, {m[1].x(), m[1].y(), m[1].z()}, {m[2].x(), m[2].y(), m[2].z()}};
}
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
  btVector3 v_before_W;  // at the start of the running step
  bool driven_by_velocity = false;
  double reach_of_contacts_m = 0;
  SweptBody swept;
};

struct FixedBody {
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> rigid;
};

btTransform Upright(const Eigen::Vector3d& p_W, double heading_rad) {
  return btTransform(btQuaternion(btVector3(0, 0, 1), heading_rad), ToBullet(p_W));
}

std::unique_ptr<btCollisionShape> MakeShape(const Model& model) {
  if (model.half_size_m().isZero()) return std::make_unique<btSphereShape>(kBallRadius_m);
  return std::make_unique<btBoxShape>(ToBullet(model.half_size_m()));
}

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

FixedBody MakeFixed(const Obstacle& obstacle, int user_index) {
  FixedBody body;
  body.shape = MakeShape(obstacle);
  body.rigid = std::make_unique<btRigidBody>(0, nullptr, body.shape.get());
  body.rigid->setWorldTransform(Upright(obstacle.p_W, obstacle.heading_rad));
  body.rigid->setUserIndex(user_index);
  return body;
}

/// Largest distance of two surfaces at which Bullet may make a contact point of them, as far as `shape` decides (m).
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
  if (!body.model->feels_gravity()) body.rigid->setFlags(body.rigid->getFlags() | BT_DISABLE_WORLD_GRAVITY);
  if (!body.model->touches_ground()) {
    body.rigid->setLinearFactor({1, 1, 0});
    body.rigid->setAngularFactor({0, 0, 1});
  }
  body.state.p_WB = agent.p_W;
  body.state.q_WB = Eigen::AngleAxisd(agent.heading_rad, Eigen::Vector3d::UnitZ());
  body.state.v_WB = agent.v_W;
  return body;
}

/// The motion of a body in Bullet now. a_WB is left at 0: it is defined by ticks, not by steps.
Motion Now(const btRigidBody& rigid) {
  const btTransform& X_WB = rigid.getWorldTransform();
  Motion now;
  now.p_WB = ToEigen(X_WB.getOrigin());
  now.q_WB = ToEigen(X_WB.getRotation());
  now.v_WB = ToEigen(rigid.getLinearVelocity());
  now.w_WB_B = ToEigen(rigid.getAngularVelocity() * X_WB.getBasis());  // v * M is M^T v
  return now;
}

BodyNow AtStep(const btRigidBody& rigid) {
  return {ToEigen(rigid.getWorldTransform().getBasis()), ToEigen(rigid.getLinearVelocity())};
}

/// The body's bounding box, with `reach_m` added on every side: outside of it the body gets no contact point.
Clearance::Box BoxAround(const btRigidBody& rigid, double reach_m) {
  btVector3 low, high;
  rigid.getAabb(low, high);
  return {ToEigen(low).array() - reach_m, ToEigen(high).array() + reach_m};
}

/// One step of a body that touches nothing: gravity, forces, torques, the gyroscopic term, then the move, in the order
/// and with the rounding errors of btDiscreteDynamicsWorld and its solver.
void StepFreely(btRigidBody& rigid, double dt_s) {
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

/// Takes back what Bullet puts the body ahead by in a step.
void CorrectPlace(Body& body, double dt_s) {
  if (body.driven_by_velocity) return;
  body.rigid->getWorldTransform().getOrigin() -= (dt_s / 2) * (body.rigid->getLinearVelocity() - body.v_before_W);
}

/// Places of a body's numbers in RotorBodies.
using F = RotorField;

void PutVector(const btVector3& v, RotorBodies& bodies, std::size_t i, int field) {
  for (int k = 0; k < 3; ++k) bodies.At(i, field + k) = v[k];
}
btVector3 VectorAt(const RotorBodies& bodies, std::size_t i, int field) {
  return {bodies.At(i, field), bodies.At(i, field + 1), bodies.At(i, field + 2)};
}

/// Writes what stays of a body's numbers.
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

/// Moves the numbers of a body out of Bullet, and back.
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

/// The motion of a body in RotorBodies now. a_WB is left at 0.
Motion Now(const RotorBodies& bodies, std::size_t i) {
  Motion now;
  now.p_WB = ToEigen(VectorAt(bodies, i, F::kP));
  for (int k = 0; k < 4; ++k) now.q_WB.coeffs()[k] = bodies.At(i, F::kQ + k);
  now.v_WB = ToEigen(VectorAt(bodies, i, F::kV));
  now.w_WB_B = ToEigen(VectorAt(bodies, i, F::kWInB));
  return now;
}

/// Applies `push` to the body for the next step.
void Apply(const Push& push, Body& body) {
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

/// Counts contacts when they begin. A contact begins when two surfaces touch, and ends when Bullet drops all its
/// points, some millimetres apart (20 at most). So resting, sliding and rattling count once.
class ContactCounter {
 public:
  explicit ContactCounter(std::size_t bodies) {
    lasting_.reserve(4 * bodies);
    now_.reserve(4 * bodies);
    begun_.first.reserve(kMaxContactsTold);
  }
  /// To be called after each step. `tick`: the one before the step; `bodies`: the agents', by id - 1. Returns true if
  /// any two bodies are so close that Bullet keeps contact points for them.
  bool Update(btDispatcher& dispatcher, std::int64_t tick, std::span<const Body> bodies) {
    bool any = false;
    now_.clear();
    const std::size_t told = begun_.first.size();
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      if (manifold.getNumContacts() == 0) continue;
      any = true;
      const Pair pair = std::minmax(manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex());
      const bool lasts = std::ranges::binary_search(lasting_, pair);
      if (!lasts && !Touches(manifold)) continue;
      now_.push_back(pair);
      if (!lasts) Begin(pair, tick, bodies);
    }
    const auto newest = begun_.first.begin() + static_cast<std::ptrdiff_t>(told);
    std::sort(newest, begun_.first.end(), [](const Contact& a, const Contact& b) {
      return std::pair(a.agent, a.other) < std::pair(b.agent, b.other);
    });
    std::ranges::sort(now_);
    lasting_.swap(now_);
    return any;
  }
  const Contacts& begun() const { return begun_; }

 private:
  using Pair = std::pair<int, int>;  // user indices, in order; at least one is an agent's

  void Begin(const Pair& pair, std::int64_t tick, std::span<const Body> bodies) {
    const bool is_of_agents = pair.first > kGroundIndex;
    ++(is_of_agents ? begun_.agents : pair.first == kGroundIndex ? begun_.ground : begun_.obstacles);
    if (begun_.first.size() == kMaxContactsTold) return;
    const int agent = is_of_agents ? pair.first : pair.second;
    const int other = is_of_agents ? pair.second : pair.first;
    // At the tick: the solver slows bodies down in the steps before they touch.
    Eigen::Vector3d v_W = bodies[static_cast<std::size_t>(agent - 1)].state.v_WB;
    if (is_of_agents) v_W -= bodies[static_cast<std::size_t>(other - 1)].state.v_WB;
    begun_.first.push_back({.tick = tick, .agent = agent, .other = other, .speed_m_per_s = v_W.norm()});
  }

  // The tolerance: the solver stops a body driven by velocity slightly before it touches; how far before depends on the
  // curvature of its path.
  static bool Touches(const btPersistentManifold& manifold) {
    constexpr double kTouching_m = 1e-4;
    for (int i = 0; i < manifold.getNumContacts(); ++i)
      if (manifold.getContactPoint(i).getDistance() <= kTouching_m) return true;
    return false;
  }

  std::vector<Pair> lasting_, now_;  // sorted; buffers with capacity, so that a step allocates nothing
  Contacts begun_;
};

}  // namespace

struct World::Impl {
  Impl(const Experiment& experiment, LookForContacts look_for_contacts, int max_lanes);
  void Tick(std::span<const Actuation> commands);
  bool IsFreeTick(std::span<const Actuation> commands);
  void FlyFreely(std::span<const Actuation> commands);
  void FlyInLanes(std::span<const Actuation> commands);
  void FlyAlone(Body& body, const Actuation& command);
  void FlyByBullet(std::span<const Actuation> commands);
  bool MayTouch();
  void TakeFromBullet();
  void GiveToBullet();
  void EndTick();
  Surroundings Around(int step) const;

  int rate_hz;
  double dt_s;
  double control_rate_hz;
  int steps_per_tick;
  std::int64_t tick = 0;
  Wind wind;
  std::vector<std::array<double, 3>> wind_W;  // by step of this tick
  LookForContacts look;
  ContactCounter contacts;
  bool any_contact = false;  // Bullet keeps contact points
  std::int64_t steps_with_contacts = 0;

  // Bodies must outlive the world that holds them, so they come first.
  Ground ground_shape;
  btRigidBody ground{0, nullptr, &ground_shape};
  std::vector<FixedBody> obstacles;
  std::vector<Body> bodies;
  btDefaultCollisionConfiguration collision;
  btCollisionDispatcher dispatcher{&collision};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &collision};
  std::optional<Clearance> clearance;
  std::vector<Clearance::Box> boxes;  // by body, at this step or of this tick

  std::vector<std::size_t> with_rotors;     // bodies
  std::optional<RotorBodies> rotor_bodies;  // those, in this order
  bool in_lanes = false;                    // rotor_bodies has their numbers, and Bullet has not
};

World::Impl::Impl(const Experiment& experiment, LookForContacts look_for_contacts, int max_lanes)
    : rate_hz(experiment.physics.rate_hz),
      dt_s(1.0 / rate_hz),
      control_rate_hz(experiment.control.rate_hz),
      steps_per_tick(experiment.steps_per_tick()),
      wind(experiment.physics.wind, experiment.run.seed, dt_s),
      wind_W(static_cast<std::size_t>(steps_per_tick)),
      look(look_for_contacts),
      contacts(experiment.agents.size()) {
  collision.setPlaneConvexMultipointIterations();  // a box then stands on four points at once
  // Bullet's own algorithm for two spheres drops a contact as soon as they are apart: spheres that slide along each
  // other would count again and again.
  dispatcher.registerCollisionCreateFunc(
      SPHERE_SHAPE_PROXYTYPE, SPHERE_SHAPE_PROXYTYPE,
      collision.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE));
  world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;  // overlap is pushed apart without giving it speed
  world.setForceUpdateAllAabbs(false);
  world.setGravity({0, 0, -experiment.physics.gravity_m_per_s2});
  ground.setUserIndex(kGroundIndex);
  if (experiment.physics.ground) world.addRigidBody(&ground, kGround, kAgents);
  for (const Obstacle& obstacle : experiment.physics.obstacles) {
    obstacles.push_back(MakeFixed(obstacle, kObstacleIndex - static_cast<int>(obstacles.size())));
    world.addRigidBody(obstacles.back().rigid.get(), kObstacles, kAgents);
  }
  Clearance::Scene scene;
  scene.can_touch_each_other = experiment.physics.collisions;
  for (const FixedBody& obstacle : obstacles)
    if (experiment.physics.collisions)
      scene.fixed.push_back(BoxAround(*obstacle.rigid, ReachOfContacts_m(*obstacle.shape)));
  bodies.reserve(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) {
    bodies.push_back(MakeBody(experiment, agent));
    const int ground_if_touched = bodies.back().model->touches_ground() ? kGround : 0;
    const int others = experiment.physics.collisions ? kAgents | kObstacles : 0;
    world.addRigidBody(bodies.back().rigid.get(), kAgents, ground_if_touched | others);
    scene.can_touch_floor.push_back(experiment.physics.ground && ground_if_touched != 0);
  }
  clearance.emplace(std::move(scene));
  boxes.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].model->rotors() != nullptr) with_rotors.push_back(i);
  rotor_bodies.emplace(with_rotors.size(), max_lanes);
  for (std::size_t k = 0; k < with_rotors.size(); ++k)
    PutConstants(bodies[with_rotors[k]], dt_s, experiment.physics.gravity_m_per_s2, *rotor_bodies, k);
}

void World::Impl::Tick(std::span<const Actuation> commands) {
  for (std::array<double, 3>& now : wind_W) Eigen::Vector3d::Map(now.data()) = wind.Next();
  if (IsFreeTick(commands))
    FlyFreely(commands);
  else
    FlyByBullet(commands);
  EndTick();
}

Surroundings World::Impl::Around(int step) const {
  return {.t_s = static_cast<double>(tick * steps_per_tick + step) / rate_hz,
          .dt_s = dt_s,
          .wind_W = Eigen::Vector3d::Map(wind_W[static_cast<std::size_t>(step)].data())};
}

/// True if no body can come close to another one, or to what is fixed, within this tick, and no rotor fails in it.
bool World::Impl::IsFreeTick(std::span<const Actuation> commands) {
  if (look == LookForContacts::kAlways || any_contact) return false;
  double max_wind = 0;
  for (const std::array<double, 3>& now : wind_W)
    max_wind = std::max(max_wind, Eigen::Vector3d::Map(now.data()).norm());
  const double first_s = Around(0).t_s, last_s = Around(steps_per_tick - 1).t_s;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Rotors* rotors = bodies[i].model->rotors();
    if (rotors != nullptr && rotors->FailuresBegun(first_s) != rotors->FailuresBegun(last_s)) return false;
    boxes[i] = SweptBox(bodies[i].state, bodies[i].swept, bodies[i].model->LimitOf(commands[i]), max_wind,
                        steps_per_tick * dt_s);
  }
  return clearance->IsClear(boxes);
}

/// Flies each body through the tick by itself.
void World::Impl::FlyFreely(std::span<const Actuation> commands) {
  FlyInLanes(commands);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].model->rotors() == nullptr) FlyAlone(bodies[i], commands[i]);
}

/// Flies the bodies with rotors through the tick.
void World::Impl::FlyInLanes(std::span<const Actuation> commands) {
  if (!in_lanes) TakeFromBullet();
  const double t_s = Around(0).t_s;
  for (std::size_t k = 0; k < with_rotors.size(); ++k) {
    const std::size_t i = with_rotors[k];
    const Eigen::Vector4d remaining = bodies[i].model->rotors()->Remaining(t_s);
    for (int r = 0; r < 4; ++r) {
      rotor_bodies->At(k, F::kCommand + r) = commands[i][static_cast<std::size_t>(r)];
      rotor_bodies->At(k, F::kRemaining + r) = remaining[r];
    }
  }
  rotor_bodies->Fly({.dt_s = dt_s, .wind_W = wind_W});
}

void World::Impl::FlyAlone(Body& body, const Actuation& command) {
  for (int step = 0; step < steps_per_tick; ++step) {
    Apply(body.model->Apply(command, AtStep(*body.rigid), Around(step)), body);
    StepFreely(*body.rigid, dt_s);
    CorrectPlace(body, dt_s);
  }
}

/// Flies the bodies through the tick step by step, with contacts where there may be some.
void World::Impl::FlyByBullet(std::span<const Actuation> commands) {
  if (in_lanes) GiveToBullet();
  for (int step = 0; step < steps_per_tick; ++step) {
    const Surroundings around = Around(step);
    for (std::size_t i = 0; i < bodies.size(); ++i)
      Apply(bodies[i].model->Apply(commands[i], AtStep(*bodies[i].rigid), around), bodies[i]);
    if (MayTouch()) {
      world.stepSimulation(dt_s, 0);
      any_contact = contacts.Update(dispatcher, tick, bodies);
      ++steps_with_contacts;
    } else {
      for (Body& body : bodies) StepFreely(*body.rigid, dt_s);
    }
    for (Body& body : bodies) CorrectPlace(body, dt_s);
  }
}

void World::Impl::TakeFromBullet() {
  for (std::size_t k = 0; k < with_rotors.size(); ++k) MoveOutOfBullet(bodies[with_rotors[k]], *rotor_bodies, k);
  in_lanes = true;
}

void World::Impl::GiveToBullet() {
  for (std::size_t k = 0; k < with_rotors.size(); ++k) MoveIntoBullet(*rotor_bodies, k, bodies[with_rotors[k]]);
  in_lanes = false;
}

/// True if bodies are so close that Bullet could make a contact in this step, or if it still keeps one.
bool World::Impl::MayTouch() {
  if (look == LookForContacts::kAlways || any_contact) return true;
  for (std::size_t i = 0; i < bodies.size(); ++i) boxes[i] = BoxAround(*bodies[i].rigid, bodies[i].reach_of_contacts_m);
  return !clearance->IsClear(boxes);
}

void World::Impl::EndTick() {
  ++tick;
  std::size_t in_rotor_bodies = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const bool is_in_lanes = in_lanes && bodies[i].model->rotors() != nullptr;
    Motion now = is_in_lanes ? Now(*rotor_bodies, in_rotor_bodies++) : Now(*bodies[i].rigid);
    Motion& state = bodies[i].state;
    if (!IsFinite(now)) throw std::runtime_error(At(tick, i) + "its state is not finite");
    if (now.q_WB.dot(state.q_WB) < 0) now.q_WB.coeffs() *= -1;  // q and -q are the same rotation: take the nearer one
    now.a_WB = (now.v_WB - state.v_WB) * control_rate_hz;
    state = now;
  }
}

World::World(const Experiment& experiment, LookForContacts look, int max_lanes)
    : impl_(std::make_unique<Impl>(experiment, look, max_lanes)) {}
World::~World() = default;

void World::Adopt(const Experiment& now) { impl_->wind.Adopt(now.physics.wind); }

Motion World::State(int id) const { return impl_->bodies[static_cast<std::size_t>(id - 1)].state; }

void World::Step(std::span<const Actuation> commands) {
  if (commands.size() != impl_->bodies.size()) throw std::invalid_argument("World::Step: one command per agent");
  CheckFinite(commands, impl_->tick);
  impl_->Tick(commands);
}

std::int64_t World::tick() const { return impl_->tick; }

const Contacts& World::contacts() const { return impl_->contacts.begun(); }

std::int64_t World::steps_with_contacts() const { return impl_->steps_with_contacts; }

}  // namespace mascot
