// In most steps nothing touches, but Bullet's broadphase, islands and solver still cost most of the step. While the
// boxes around all bodies are apart (Clearance), we move each body by itself, with exactly the operations of a whole
// step, so that the bits are the same: through a whole tick if the boxes that the bodies cannot leave meanwhile
// (SweptBox) are apart, else step by step. In whole ticks, bodies with rotors are flown several at once (RotorBodies),
// which then have their numbers, and Bullet has not.
#include "physics_server/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "physics_server/bullet/body.h"
#include "physics_server/bullet/body_in_lanes.h"
#include "physics_server/bullet/contact_counter.h"
#include "physics_server/bullet/scene.h"
#include "physics_server/clearance.h"
#include "physics_server/lanes/rotor_bodies.h"
#include "physics_server/model.h"
#include "physics_server/swept_box.h"
#include "physics_server/wind.h"

namespace mascot {
namespace {

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

  std::vector<Body> bodies;
  Scene scene;  // after the bodies that it holds
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
      contacts(experiment.agents.size()),
      scene(experiment) {
  Clearance::Scene what_touches;
  what_touches.can_touch_each_other = experiment.physics.collisions;
  if (experiment.physics.collisions) what_touches.fixed = scene.BoxesOfObstacles();
  bodies.reserve(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) {
    Body& body = bodies.emplace_back(MakeBody(experiment, agent));
    scene.Add(body);
    what_touches.can_touch_floor.push_back(experiment.physics.ground && body.model->touches_ground());
  }
  clearance.emplace(std::move(what_touches));
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
      rotor_bodies->At(k, RotorField::kCommand + r) = commands[i][static_cast<std::size_t>(r)];
      rotor_bodies->At(k, RotorField::kRemaining + r) = remaining[r];
    }
  }
  rotor_bodies->Fly({.dt_s = dt_s, .wind_W = wind_W});
}

void World::Impl::FlyAlone(Body& body, const Actuation& command) {
  for (int step = 0; step < steps_per_tick; ++step) {
    PushBody(body, command, Around(step));
    StepFreely(*body.rigid, dt_s);
    CorrectPlace(body, dt_s);
  }
}

/// Flies the bodies through the tick step by step, with contacts where there may be some.
void World::Impl::FlyByBullet(std::span<const Actuation> commands) {
  if (in_lanes) GiveToBullet();
  for (int step = 0; step < steps_per_tick; ++step) {
    const Surroundings around = Around(step);
    for (std::size_t i = 0; i < bodies.size(); ++i) PushBody(bodies[i], commands[i], around);
    if (MayTouch()) {
      scene.Step(dt_s);
      any_contact = contacts.Update(scene.dispatcher(), tick, bodies);
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
