// What quadrotors cost in loops that a researcher would write by hand, or with another engine: N of them hover above
// each other at 1 kHz under a PD law of attitude and height. No messages, no graph, no recording, no limits.
//   peers bullet|rk4|mujoco AGENTS SECONDS     prints one line of JSON: agent-steps per second
// bullet: a world of boxes, as its manual says, forces before each step; contacts on. rk4: Euler's equations of each
// body by Runge-Kutta of order 4. mujoco: free bodies in one model, with its default integrator; contacts on.
#include <btBulletDynamicsCommon.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#ifdef MASCOT_MUJOCO
#include <mujoco/mujoco.h>
#endif

namespace {

using Eigen::Vector3d;
using WallClock = std::chrono::steady_clock;

constexpr double kDt_s = 0.001, kG = 9.81, kMass_kg = 1.477;
constexpr double kInertia[3] = {0.1152, 0.1152, 0.218};
constexpr double kSize_m[3] = {0.7, 0.7, 0.12};
double Height_m(int i) { return 2 + i; }

struct Wrench {
  Vector3d f_W, tau_B;
};

/// Level and at its height.
Wrench Pd(const Vector3d& p_W, const Vector3d& v_W, const Eigen::Matrix3d& R_WB, const Vector3d& w_B, double height_m) {
  const double thrust_n = kMass_kg * (kG + 25 * (height_m - p_W.z()) - 10 * v_W.z());
  const Vector3d tilt(R_WB(2, 1), -R_WB(2, 0), 0);
  return {thrust_n * R_WB.col(2), Vector3d::Map(kInertia).cwiseProduct(-625 * tilt - 30 * w_B)};
}

class BulletLoop {
 public:
  explicit BulletLoop(int agents) {
    world_.setGravity({0, 0, -kG});
    for (int i = 0; i < agents; ++i) {
      btRigidBody::btRigidBodyConstructionInfo info(kMass_kg, nullptr, &box_, {kInertia[0], kInertia[1], kInertia[2]});
      info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), {0, 0, Height_m(i)});
      bodies_.push_back(std::make_unique<btRigidBody>(info));
      bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
      world_.addRigidBody(bodies_.back().get());
    }
  }
  ~BulletLoop() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  BulletLoop(const BulletLoop&) = delete;
  BulletLoop& operator=(const BulletLoop&) = delete;

  void Step() {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      btRigidBody& body = *bodies_[i];
      const btMatrix3x3& basis = body.getWorldTransform().getBasis();
      Eigen::Matrix3d R_WB;
      for (int row = 0; row < 3; ++row)
        for (int k = 0; k < 3; ++k) R_WB(row, k) = basis[row][k];
      const btVector3 w_B = body.getAngularVelocity() * basis;
      const Wrench wrench = Pd(ToEigen(body.getWorldTransform().getOrigin()), ToEigen(body.getLinearVelocity()), R_WB,
                               ToEigen(w_B), Height_m(static_cast<int>(i)));
      body.applyCentralForce({wrench.f_W.x(), wrench.f_W.y(), wrench.f_W.z()});
      body.applyTorque(basis * btVector3(wrench.tau_B.x(), wrench.tau_B.y(), wrench.tau_B.z()));
    }
    world_.stepSimulation(kDt_s, 0);
  }

 private:
  static Vector3d ToEigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

  btBoxShape box_{{kSize_m[0] / 2, kSize_m[1] / 2, kSize_m[2] / 2}};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDefaultCollisionConfiguration collision_;
  btCollisionDispatcher dispatcher_{&collision_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &collision_};
};

class Rk4Loop {
 public:
  explicit Rk4Loop(int agents) : bodies_(static_cast<std::size_t>(agents)) {
    for (int i = 0; i < agents; ++i) bodies_[static_cast<std::size_t>(i)].segment<3>(0) = Vector3d(0, 0, Height_m(i));
    for (State& body : bodies_) body[9] = 1;
  }
  void Step() {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      State& x = bodies_[i];
      const Eigen::Quaterniond q(x[9], x[6], x[7], x[8]);
      const Wrench wrench =
          Pd(x.segment<3>(0), x.segment<3>(3), q.toRotationMatrix(), x.segment<3>(10), Height_m(static_cast<int>(i)));
      const State k1 = Rate(x, wrench), k2 = Rate(x + kDt_s / 2 * k1, wrench), k3 = Rate(x + kDt_s / 2 * k2, wrench),
                  k4 = Rate(x + kDt_s * k3, wrench);
      x += kDt_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      x.segment<4>(6).normalize();
    }
  }

 private:
  using State = Eigen::Matrix<double, 13, 1>;  // p, v, q (x, y, z, w), w_B
  static State Rate(const State& x, const Wrench& wrench) {
    const Eigen::Quaterniond q(x[9], x[6], x[7], x[8]);
    const Vector3d w_B = x.segment<3>(10), inertia = Vector3d::Map(kInertia);
    State rate;
    rate.segment<3>(0) = x.segment<3>(3);
    rate.segment<3>(3) = wrench.f_W / kMass_kg - kG * Vector3d::UnitZ();
    rate.segment<4>(6) = 0.5 * (q * Eigen::Quaterniond(0, w_B.x(), w_B.y(), w_B.z())).coeffs();
    rate.segment<3>(10) = (wrench.tau_B - w_B.cross(inertia.cwiseProduct(w_B))).cwiseQuotient(inertia);
    return rate;
  }
  std::vector<State> bodies_ = {};
};

#ifdef MASCOT_MUJOCO
class MujocoLoop {
 public:
  explicit MujocoLoop(int agents) {
    std::string xml = "<mujoco><option timestep='0.001' gravity='0 0 -9.81'/><size nconmax='100'/><worldbody>";
    for (int i = 0; i < agents; ++i)
      xml += "<body pos='0 0 " + std::to_string(Height_m(i)) +
             "'><freejoint/><inertial pos='0 0 0' mass='1.477' diaginertia='0.1152 0.1152 0.218'/>"
             "<geom type='box' size='0.35 0.35 0.06'/></body>";
    xml += "</worldbody></mujoco>";
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "peers.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(files.filedata[0]));
    char error[1000] = "";
    model_ = mj_loadXML("peers.xml", &files, error, sizeof error);
    mj_deleteVFS(&files);
    if (model_ == nullptr) {
      std::fprintf(stderr, "mujoco: %s\n", error);
      std::exit(1);
    }
    data_ = mj_makeData(model_);
  }
  ~MujocoLoop() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoLoop(const MujocoLoop&) = delete;
  MujocoLoop& operator=(const MujocoLoop&) = delete;

  void Step() {
    for (std::ptrdiff_t i = 0; i + 1 < model_->nbody; ++i) {
      const double *p = data_->qpos + 7 * i, *v = data_->qvel + 6 * i;  // v: linear in W, angular in B
      const Eigen::Quaterniond q(p[3], p[4], p[5], p[6]);
      const Eigen::Matrix3d R_WB = q.toRotationMatrix();
      const Wrench wrench =
          Pd(Vector3d::Map(p), Vector3d::Map(v), R_WB, Vector3d::Map(v + 3), Height_m(static_cast<int>(i)));
      Vector3d::Map(data_->xfrc_applied + 6 * (i + 1)) = wrench.f_W;
      Vector3d::Map(data_->xfrc_applied + 6 * (i + 1) + 3) = R_WB * wrench.tau_B;
    }
    mj_step(model_, data_);
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};
#endif

template <class Loop>
int Measure(int agents, double seconds) {
  Loop loop(agents);
  const auto start = WallClock::now();
  std::chrono::duration<double> wall{};
  long steps = 0;
  for (; wall.count() < seconds; wall = WallClock::now() - start)
    for (int k = 0; k < 10; ++k, ++steps) loop.Step();
  std::printf("{\"agent_steps_per_s\": %.0f}\n", static_cast<double>(steps) * agents / wall.count());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string peer = argc == 4 ? argv[1] : "";
  const int agents = argc == 4 ? std::atoi(argv[2]) : 0;
  const double seconds = argc == 4 ? std::atof(argv[3]) : 0;
  if (agents > 0 && peer == "bullet") return Measure<BulletLoop>(agents, seconds);
  if (agents > 0 && peer == "rk4") return Measure<Rk4Loop>(agents, seconds);
#ifdef MASCOT_MUJOCO
  if (agents > 0 && peer == "mujoco") return Measure<MujocoLoop>(agents, seconds);
#endif
  std::fprintf(stderr,
               "usage: peers bullet|rk4|mujoco AGENTS SECONDS (mujoco: if libmujoco-dev was there at the build)\n");
  return 2;
}
