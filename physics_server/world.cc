// In most ticks most bodies touch nothing, but Bullet's broadphase, islands and solver would cost most of the step. So
// Bullet gets those bodies only that may touch something within the tick: whose boxes (SweptBox), which they cannot
// leave in it, meet each other, an obstacle or the ground (Clearance). Even for these it looks for contacts only in
// steps in which their boxes at that step meet. Every other body we move by itself, with exactly the operations of a
// whole step, so that the bits are the same; bodies with rotors several at once (RotorBodies).
#include "physics_server/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "physics_server/bullet/body.h"
#include "physics_server/bullet/body_in_lanes.h"
#include "physics_server/bullet/contact_counter.h"
#include "physics_server/bullet/conversions.h"
#include "physics_server/bullet/scene.h"
#include "physics_server/clearance.h"
#include "physics_server/faulty_motors.h"
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

/// Beyond it a body that is moved from outside jumps.
constexpr double kMaxMoveSpeed_m_per_s = 50;

/// What flies a body, and has its numbers.
enum class By { kBullet, kItself, kLanes };

struct World::Impl {
  Impl(const Experiment& experiment, LookForContacts look_for_contacts, int max_lanes, Crew& crew);
  void Tick(std::span<const Actuation> commands);
  void DecideWhoFlies(std::span<const Actuation> commands);
  By DecideFor(std::size_t i) const;
  Clearance::Box SweptBoxOf(std::size_t i, const Motion& now, const Actuation& command) const;
  void GiveTo(By by, std::size_t i);
  void FlyByBullet(std::span<const Actuation> commands);
  bool MayTouch();
  void PullIn(std::span<const Actuation> commands, int steps);
  void FlyAlone(Body& body, const Actuation& command, int steps);
  void FlyInLanes(std::span<const Actuation> commands, std::size_t first_block, std::size_t end_block);
  void EndTick(std::size_t i);
  std::span<const Actuation> WithMoves(std::span<const Actuation> commands);
  void EndMove(std::size_t i, Motion& now);
  Surroundings Around(int step) const;

  Crew& crew;
  int rate_hz;
  double dt_s;
  double control_rate_hz;
  int steps_per_tick;
  std::int64_t tick = 0;
  Wind wind;
  std::vector<std::array<double, 3>> wind_W;  // by step of this tick
  FaultyMotors motors;
  LookForContacts look;
  ContactCounter contacts;
  std::int64_t steps_with_contacts = 0;

  std::vector<Body> bodies;
  std::map<std::size_t, Motion> moves;  // by body that is moved from outside: where it is at the end of the next tick
  std::vector<Actuation> with_moves;    // commands, and the velocities of these bodies
  Scene scene;                          // after the bodies that it holds
  std::vector<By> by;                   // body
  std::vector<char> is_in_contact;      // by body: Bullet keeps contact points for it
  std::vector<std::size_t> by_bullet;
  double max_wind_m_per_s = 0;  // in this tick

  std::optional<Clearance> clearance;
  std::vector<Clearance::Box> swept_boxes;  // by body: of this tick
  std::vector<Clearance::Box> boxes;        // by body: at this step, of those flown by Bullet

  std::vector<std::size_t> with_rotors;     // bodies
  std::optional<RotorBodies> rotor_bodies;  // those, in this order
  std::vector<std::size_t> lane_of;         // by body, if it has rotors: its place in rotor_bodies
};

World::Impl::Impl(const Experiment& experiment, LookForContacts look_for_contacts, int max_lanes, Crew& crew_of_run)
    : crew(crew_of_run),
      rate_hz(experiment.physics.rate_hz),
      dt_s(1.0 / rate_hz),
      control_rate_hz(experiment.control.rate_hz),
      steps_per_tick(experiment.steps_per_tick()),
      wind(experiment.physics.wind, experiment.run.seed, dt_s),
      wind_W(static_cast<std::size_t>(steps_per_tick)),
      motors(experiment),
      look(look_for_contacts),
      contacts(experiment.agents.size()),
      scene(experiment) {
  Clearance::Scene what_touches;
  what_touches.can_touch_each_other = experiment.physics.collisions;
  if (experiment.physics.collisions) what_touches.fixed = scene.BoxesOfObstacles();
  bodies.reserve(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) {
    Body& body = bodies.emplace_back(MakeBody(experiment, agent));
    if (agent.vehicle) moves.emplace(bodies.size() - 1, body.state);
    what_touches.can_touch_floor.push_back(experiment.physics.ground && body.model->touches_ground());
  }
  clearance.emplace(std::move(what_touches));
  by.resize(bodies.size(), By::kItself);
  is_in_contact.resize(bodies.size());
  by_bullet.reserve(bodies.size());
  boxes.resize(bodies.size());
  swept_boxes.resize(bodies.size());
  lane_of.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].model->rotors() != nullptr) {
      lane_of[i] = with_rotors.size();
      with_rotors.push_back(i);
    }
  rotor_bodies.emplace(with_rotors.size(), max_lanes);
  for (std::size_t k = 0; k < with_rotors.size(); ++k)
    PutConstants(bodies[with_rotors[k]], dt_s, experiment.physics.gravity_m_per_s2, *rotor_bodies, k);
}

void World::Impl::Tick(std::span<const Actuation> commands) {
  max_wind_m_per_s = 0;
  for (std::array<double, 3>& now : wind_W) {
    const Eigen::Vector3d w = wind.Next();
    Eigen::Vector3d::Map(now.data()) = w;
    max_wind_m_per_s = std::max(max_wind_m_per_s, w.norm());
  }
  DecideWhoFlies(commands);
  FlyByBullet(commands);
  crew.Share(rotor_bodies->blocks(), std::size_t{kMinAgentsPerThread} / rotor_bodies->lanes(),
             [&](std::size_t first, std::size_t end) { FlyInLanes(commands, first, end); });
  crew.Share(bodies.size(), std::size_t{kMinAgentsPerThread}, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      if (by[i] == By::kItself) FlyAlone(bodies[i], commands[i], steps_per_tick);
      EndTick(i);
    }
  });
  ++tick;
}

Surroundings World::Impl::Around(int step) const {
  return {.t_s = static_cast<double>(tick * steps_per_tick + step) / rate_hz,
          .dt_s = dt_s,
          .wind_W = Eigen::Vector3d::Map(wind_W[static_cast<std::size_t>(step)].data())};
}

Clearance::Box World::Impl::SweptBoxOf(std::size_t i, const Motion& now, const Actuation& command) const {
  const Body& body = bodies[i];
  return SweptBox(now, body.swept, body.model->LimitOf(command), max_wind_m_per_s, steps_per_tick * dt_s);
}

void World::Impl::DecideWhoFlies(std::span<const Actuation> commands) {
  crew.Share(bodies.size(), std::size_t{kMinAgentsPerThread}, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) swept_boxes[i] = SweptBoxOf(i, bodies[i].state, commands[i]);
  });
  clearance->Look(swept_boxes);
  std::ranges::fill(is_in_contact, char{false});
  for (const ContactCounter::Pair& pair : contacts.kept())
    for (const int index : {pair.first, pair.second})
      if (index > 0) is_in_contact[static_cast<std::size_t>(index - 1)] = true;
  by_bullet.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) GiveTo(DecideFor(i), i);
}

By World::Impl::DecideFor(std::size_t i) const {
  if (look == LookForContacts::kAlways || clearance->MetSomething(i) || is_in_contact[i]) return By::kBullet;
  const Rotors* rotors = bodies[i].model->rotors();
  if (rotors == nullptr) return By::kItself;
  const bool fails_within =
      rotors->FailuresBegun(Around(0).t_s) != rotors->FailuresBegun(Around(steps_per_tick - 1).t_s);
  return fails_within ? By::kItself : By::kLanes;
}

void World::Impl::GiveTo(By next, std::size_t i) {
  if (next == By::kBullet) by_bullet.push_back(i);
  if (by[i] == next) return;
  if (by[i] == By::kBullet) scene.Remove(bodies[i]);
  if (by[i] == By::kLanes) MoveIntoBullet(*rotor_bodies, lane_of[i], bodies[i]);
  if (next == By::kBullet) scene.Add(bodies[i]);
  if (next == By::kLanes) MoveOutOfBullet(bodies[i], *rotor_bodies, lane_of[i]);
  if (bodies[i].model->rotors() != nullptr) rotor_bodies->SetFlown(lane_of[i], next == By::kLanes);
  by[i] = next;
}

/// Flies the bodies that may touch something through the tick step by step, with contacts where there may be some.
void World::Impl::FlyByBullet(std::span<const Actuation> commands) {
  if (by_bullet.empty()) return;
  for (int step = 0; step < steps_per_tick; ++step) {
    const Surroundings around = Around(step);
    for (const std::size_t i : by_bullet) PushBody(bodies[i], commands[i], around);
    const bool may_touch = MayTouch();
    if (may_touch) {
      scene.Step(dt_s);
      contacts.Update(scene.dispatcher(), tick, bodies);
      ++steps_with_contacts;
    } else {
      for (const std::size_t i : by_bullet) StepFreely(bodies[i], dt_s);
    }
    for (const std::size_t i : by_bullet) CorrectPlace(bodies[i], dt_s);
    if (may_touch) PullIn(commands, step + 1);
  }
}

/// True if bodies are so close that Bullet could make a contact in this step, or if it still keeps one.
bool World::Impl::MayTouch() {
  if (look == LookForContacts::kAlways || !contacts.kept().empty()) return true;
  for (const std::size_t i : by_bullet) boxes[i] = BoxAround(bodies[i]);
  return clearance->DoMeet(boxes);
}

/// A contact may throw a body out of its box. If it did after this many steps, Bullet gets those that the body may
/// reach now.
void World::Impl::PullIn(std::span<const Actuation> commands, int steps) {
  bool was_thrown = false;
  for (const std::size_t i : by_bullet) {
    const Clearance::Box now = BoxAround(bodies[i]);
    Clearance::Box& box = swept_boxes[i];
    if ((now.low >= box.low).all() && (now.high <= box.high).all()) continue;
    const Clearance::Box next = SweptBoxOf(i, Now(*bodies[i].rigid), commands[i]);
    box = {box.low.min(next.low), box.high.max(next.high)};
    was_thrown = true;
  }
  if (!was_thrown) return;
  clearance->Look(swept_boxes);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (by[i] == By::kBullet || !clearance->MetSomething(i)) continue;
    GiveTo(By::kItself, i);
    FlyAlone(bodies[i], commands[i], steps);
    GiveTo(By::kBullet, i);
  }
}

void World::Impl::FlyAlone(Body& body, const Actuation& command, int steps) {
  for (int step = 0; step < steps; ++step) {
    PushBody(body, command, Around(step));
    StepFreely(body, dt_s);
    CorrectPlace(body, dt_s);
  }
}

/// Flies those bodies with rotors through the tick that touch nothing, of these blocks of rotor_bodies.
void World::Impl::FlyInLanes(std::span<const Actuation> commands, std::size_t first_block, std::size_t end_block) {
  const double t_s = Around(0).t_s;
  const std::size_t end = std::min(end_block * rotor_bodies->lanes(), with_rotors.size());
  for (std::size_t k = first_block * rotor_bodies->lanes(); k < end; ++k) {
    const std::size_t i = with_rotors[k];
    if (by[i] != By::kLanes) continue;
    const Eigen::Vector4d remaining = bodies[i].model->rotors()->Remaining(t_s);
    for (int r = 0; r < 4; ++r) {
      rotor_bodies->At(k, RotorField::kCommand + r) = commands[i][static_cast<std::size_t>(r)];
      rotor_bodies->At(k, RotorField::kRemaining + r) = remaining[r];
    }
  }
  rotor_bodies->Fly({.dt_s = dt_s, .wind_W = wind_W}, first_block, end_block);
}

/// The commands, but for bodies that are moved from outside the velocities that take them to their next places.
std::span<const Actuation> World::Impl::WithMoves(std::span<const Actuation> commands) {
  if (moves.empty()) return commands;
  with_moves.assign(commands.begin(), commands.end());
  for (const auto& [i, to] : moves) {
    Eigen::Vector3d v_W = (to.p_WB - bodies[i].state.p_WB) * control_rate_hz;
    if (v_W.norm() > kMaxMoveSpeed_m_per_s)
      v_W.setZero();  // it was not heard for long: it does not hit what is between
    with_moves[i] = {v_W.x(), v_W.y(), v_W.z(), 0};
  }
  return with_moves;
}

/// Puts a body that is moved from outside exactly where it is.
void World::Impl::EndMove(std::size_t i, Motion& now) {
  const auto move = moves.find(i);
  if (move == moves.end()) return;
  now = move->second;
  bodies[i].rigid->setWorldTransform(btTransform(ToBullet(now.q_WB), ToBullet(now.p_WB)));
}

void World::Impl::EndTick(std::size_t i) {
  Motion now = by[i] == By::kLanes ? Now(*rotor_bodies, lane_of[i]) : Now(*bodies[i].rigid);
  EndMove(i, now);
  Motion& state = bodies[i].state;
  if (!IsFinite(now)) throw std::runtime_error(At(tick + 1, i) + "its state is not finite");
  if (now.q_WB.dot(state.q_WB) < 0) now.q_WB.coeffs() *= -1;  // q and -q are the same rotation: take the nearer one
  now.a_WB = (now.v_WB - state.v_WB) * control_rate_hz;
  state = now;
}

World::World(const Experiment& experiment, LookForContacts look, int max_lanes, Crew& crew)
    : impl_(std::make_unique<Impl>(experiment, look, max_lanes, crew)) {}
World::~World() = default;

void World::Adopt(const Experiment& now) {
  impl_->wind.Adopt(now.physics.wind);
  impl_->motors.Adopt(now);
}

Motion World::State(int id) const { return impl_->bodies[static_cast<std::size_t>(id - 1)].state; }

void World::Step(std::span<const Actuation> commands) {
  if (commands.size() != impl_->bodies.size()) throw std::invalid_argument("World::Step: one command per agent");
  CheckFinite(commands, impl_->tick);
  impl_->Tick(impl_->WithMoves(impl_->motors.CarriedOut(impl_->tick, commands)));
}

void World::Place(int id, const Motion& at) {
  Move(id, at);
  const auto i = static_cast<std::size_t>(id - 1);
  impl_->EndMove(i, impl_->bodies[i].state);
}

void World::Move(int id, const Motion& to) { impl_->moves.at(static_cast<std::size_t>(id - 1)) = to; }

std::int64_t World::tick() const { return impl_->tick; }

const Contacts& World::contacts() const { return impl_->contacts.begun(); }

std::int64_t World::steps_with_contacts() const { return impl_->steps_with_contacts; }

}  // namespace mascot
