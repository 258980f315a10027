#include "tests/fakes/quadrotor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "agent/controller.h"
#include "experiment/airframe.h"
#include "physics_server/world.h"

namespace mascot::fakes {
namespace {

Experiment OneQuadrotor(const Eigen::Vector3d& place_ENU) {
  Experiment experiment;
  AgentConfig agent;
  agent.id = 1;
  agent.model = "quadrotor";
  agent.airframe = *std::ranges::find(Airframes(), "mascot", &Airframe::name);
  agent.airframe.position = agent.airframe.altitude = {};  // accelerations alone: an autopilot's loops stand above them
  agent.p_W = place_ENU + Eigen::Vector3d(0, 0, agent.airframe.size_m.z() / 2);
  agent.law.axes = Axes::kXyz;
  experiment.agents.push_back(agent);
  experiment.control.rate_hz = static_cast<int>(std::lround(1 / Quadrotor::kPeriod_s));
  return experiment;
}

}  // namespace

struct Quadrotor::Parts {
  explicit Parts(const Eigen::Vector3d& place_ENU)
      : experiment(OneQuadrotor(place_ENU)), world(experiment), stack(experiment, 1) {}
  Experiment experiment;
  World world;
  ControllerOfOne stack;
};

Quadrotor::Quadrotor(const Eigen::Vector3d& place_ENU) : parts_(std::make_unique<Parts>(place_ENU)) {}
Quadrotor::~Quadrotor() = default;

Motion Quadrotor::motion() const { return parts_->world.State(1); }
Eigen::Vector3d Quadrotor::boot_ENU() const { return parts_->experiment.agent(1).p_W; }

void Quadrotor::Step(const std::optional<Eigen::Vector3d>& acceleration_ENU) {
  constexpr double kNear_m = 0.03, kSlow_m_per_s = 0.1;
  std::array<Actuation, 1> actuators{};
  if (acceleration_ENU) actuators[0] = parts_->stack.Actuate(motion(), *acceleration_ENU).actuator;
  parts_->world.Step(actuators);
  const bool rests = height_m() < kNear_m && motion().v_WB.norm() < kSlow_m_per_s;
  resting_s_ = rests ? resting_s_ + kPeriod_s : 0;
  if (flown_s_ > 0 || height_m() > kOffTheGround_m) flown_s_ += kPeriod_s;
}

}  // namespace mascot::fakes
