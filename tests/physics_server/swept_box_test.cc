// Whatever happens to a body within a tick, it stays in the box that it is said not to leave.
#include "physics_server/swept_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "physics_server/world.h"
#include "tests/physics_server/one_body.h"

namespace mascot {
namespace {

using Eigen::Vector3d;

/// Half of the body's box along x, y, z of W.
Eigen::Array3d Around(const Motion& state, const SweptBody& body) {
  if (body.half_size_m.norm() > body.radius_m) return Eigen::Array3d::Constant(body.radius_m);  // a ball
  return (state.q_WB.toRotationMatrix().cwiseAbs() * body.half_size_m).array();
}

/// The share of the box that a body uses of it, at most 1: flown through `ticks` random ticks.
double MostUsed(std::string_view model_name, const Airframe& airframe, int control_rate_hz, double gusts,
                unsigned seed) {
  Experiment e = Bodies(model_name, {{0, 0, 1000}}, airframe);
  e.control.rate_hz = control_rate_hz;
  e.physics.wind.gust_std_m_per_s = gusts;
  e.agents[0].v_W = {3, -4, 1};
  World world(e);
  const std::unique_ptr<Model> model = MakeModel(e, 1);
  const SweptBody body = MakeSweptBody(*model, e.physics.gravity_m_per_s2, 0);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  double most = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const Motion before = world.State(1);
    Actuation command{};
    // Rotors from stopped to full, so that the body tumbles; else forces and velocities of a few units.
    for (double& value : command)
      value = model->rotors() != nullptr ? (1 + unit(random)) * airframe.MaxRotorSpeed() : 5 * unit(random);
    const Clearance::Box box = SweptBox(before, body, model->LimitOf(command), 10 * gusts, 1.0 / e.control.rate_hz);
    world.Step({&command, 1});
    const Motion after = world.State(1);
    const Eigen::Array3d reaches = Around(after, body), way = after.p_WB.array() - before.p_WB.array();
    const Eigen::Array3d room = (box.high - box.low) / 2;
    most = std::max(most, ((way.abs() + reaches) / room).maxCoeff());
  }
  return most;
}

TEST(SweptBox, HoldsTheBodyUntilTheEndOfTheTick) {
  for (const char* airframe : {"mascot", "crazyflie"})
    for (const int rate_hz : {50, 100, 500}) {
      EXPECT_LE(MostUsed("quadrotor", Built(airframe), rate_hz, 0, 1), 1) << airframe << rate_hz;
      EXPECT_LE(MostUsed("quadrotor", Built(airframe), rate_hz, 3, 2), 1) << airframe << rate_hz;
    }
  for (const char* model : {"double_integrator", "single_integrator", "unicycle"})
    EXPECT_LE(MostUsed(model, Built("mascot"), 100, 0, 3), 1) << model;
}

TEST(SweptBox, IsNotMuchLargerThanTheBodyNeeds) {
  EXPECT_GT(MostUsed("quadrotor", Built("mascot"), 100, 0, 1), 0.7);
  EXPECT_GT(MostUsed("single_integrator", Built("mascot"), 100, 0, 1), 0.9);
  // A body that hovers has hardly more than its own box, so that teams may hover close to each other.
  Experiment e = Bodies("quadrotor", {{0, 0, 10}});
  const std::unique_ptr<Model> model = MakeModel(e, 1);
  const SweptBody body = MakeSweptBody(*model, e.physics.gravity_m_per_s2, 0);
  const Clearance::Box box = SweptBox(World(e).State(1), body, model->LimitOf({}), 0, 0.01);
  EXPECT_LT(((box.high - box.low) / 2 - body.half_size_m.array()).maxCoeff(), 0.03);
}

TEST(SweptBox, HasItsReachOnEverySide) {
  const Experiment e = Bodies("quadrotor", {{0, 0, 10}});
  const std::unique_ptr<Model> model = MakeModel(e, 1);
  SweptBody body = MakeSweptBody(*model, e.physics.gravity_m_per_s2, 0);
  const Motion state = World(e).State(1);
  const Clearance::Box without = SweptBox(state, body, model->LimitOf({}), 0, 0.01);
  body.reach_m = 0.25;
  const Clearance::Box with = SweptBox(state, body, model->LimitOf({}), 0, 0.01);
  EXPECT_TRUE(((without.low - with.low - 0.25).abs() < 1e-12).all());
  EXPECT_TRUE(((with.high - without.high - 0.25).abs() < 1e-12).all());
}

TEST(SweptBox, IsUnlimitedWhereDragCouldDoAnything) {
  Airframe airframe = Built("mascot");
  airframe.linear_drag_kg_per_s = 100;
  const Experiment e = Bodies("quadrotor", {{0, 0, 10}}, airframe);
  const std::unique_ptr<Model> model = MakeModel(e, 1);
  const Clearance::Box box = SweptBox(World(e).State(1), MakeSweptBody(*model, 9.81, 0), model->LimitOf({}), 0, 0.01);
  EXPECT_TRUE((box.high == std::numeric_limits<double>::infinity()).all());
  EXPECT_TRUE((box.low == -std::numeric_limits<double>::infinity()).all());
}

}  // namespace
}  // namespace mascot
