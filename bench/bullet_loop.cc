// Bullet alone, the yardstick for the engines: ten free boxes at 1 kHz, one force and one torque each per step, no
// ground, no agents, no recording. Prints one line of JSON: steps per second, and simulated over wall time.
#include <btBulletDynamicsCommon.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

namespace {

constexpr int kBodies = 10;
constexpr int kWarmUpSteps = 2000;
constexpr int kSteps = 40000;
constexpr btScalar kStep_s = 0.001;
constexpr btScalar kMass_kg = 1.477;
constexpr btScalar kGravity_m_per_s2 = 9.81;

class Bodies {
 public:
  Bodies() {
    world_.setGravity(btVector3(0, 0, -kGravity_m_per_s2));
    for (int i = 0; i < kBodies; ++i) Add(btVector3(3 * i, 0, 1 + i));
  }
  ~Bodies() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  void Step() {
    for (const auto& body : bodies_) {
      body->applyCentralForce(btVector3(0, 0, kMass_kg * kGravity_m_per_s2));  // hovers
      body->applyTorque(btVector3(0, 0, 0));
    }
    world_.stepSimulation(kStep_s, 0);
  }

 private:
  void Add(const btVector3& p_W) {
    btVector3 inertia_kg_m2(0.1152, 0.1152, 0.218);
    bodies_.push_back(std::make_unique<btRigidBody>(kMass_kg, nullptr, &shape_, inertia_kg_m2));
    btRigidBody& body = *bodies_.back();
    body.setWorldTransform(btTransform(btQuaternion::getIdentity(), p_W));
    body.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&body);
  }

  btBoxShape shape_{btVector3(0.25, 0.25, 0.05)};
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace

int main() {
  Bodies bodies;
  for (int k = 0; k < kWarmUpSteps; ++k) bodies.Step();
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < kSteps; ++k) bodies.Step();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const double steps_per_s = kSteps / wall.count();
  std::printf("{\"steps_per_s\": %.0f, \"real_time_factor\": %.2f}\n", steps_per_s, steps_per_s * kStep_s);
}
