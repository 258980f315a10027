#include "experiment/physics.h"

#include "base/enum_names.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxObstacles = 1000, kMaxFailures = 40000;
constexpr Range kCentre_m = {-1e6, 1e6};
constexpr Range kAirspeed_m_per_s = {-200, 200};
constexpr Key kWindKeys[] = {
    key::Vector3("mean_m_per_s", kAirspeed_m_per_s, "mean wind, in W").Default("[0, 0, 0]").Live(),
    key::Number("gust_std_m_per_s", {0, 200}, "standard deviation of the gusts, per axis").Default("0.0").Live(),
    key::Number("gust_time_s", Above(0, 1e4), "correlation time of the gusts, a first-order Gauss-Markov process")
        .Default("1.0")
        .Live(),
};

constexpr Key kObstacleKeys[] = {
    key::OneOf("shape", kShapes.names(), "shape of the obstacle").Required(),
    key::Vector3("position_m", kCentre_m, "centre of the obstacle, in W").Required(),
    key::Vector3("size_m", {1e-3, 1e4},
                 "full lengths; for a sphere its diameter three times; for a cylinder, which stands upright, its "
                 "diameter twice, then its height")
        .Required(),
    key::Number("heading_rad", {-10, 10}, "yaw").Default("0.0"),
};

constexpr Key kRotorFailureKeys[] = {
    key::Integer("agent", 1, 10000, "a quadrotor's number").Required(),
    key::Integer("rotor", 1, 4, "1 front, 2 left, 3 back, 4 right").Required(),
    key::Number("at_s", {0, 1e6}, "time of the failure").Required(),
    key::Number("remaining", {0, 1}, "fraction of the rotor's thrust and torque that remains").Default("0.0"),
};

constexpr Key kPhysicsKeys[] = {
    key::Integer("rate_hz", 1, 100000, "steps of the physics per simulated second").Default("1000"),
    key::Number("gravity_m_per_s2", {0, 100}, "gravity, downwards; integrators feel none").Default("9.81"),
    key::Boolean("collisions", "bodies can touch each other and obstacles (the ground has its own key, `ground`)")
        .Default("true"),
    key::Boolean("ground", "the ground, a plane at z = 0, exists").Default("true"),
    key::Table("wind", kWindKeys, "air that moves, the same for all quadrotors"),
    key::Tables("obstacles", kObstacleKeys, "solid things that do not move; at most 1000"),
    key::Tables("rotor_failures", kRotorFailureKeys, "rotors that lose thrust; at most 40000"),
};

Obstacle ReadObstacle(Section& section) {
  Obstacle obstacle;
  obstacle.shape = kShapes.Value(section.OneOf("shape"));
  obstacle.p_W = section.Vector3("position_m");
  obstacle.size_m = section.Vector3("size_m");
  obstacle.heading_rad = section.Number("heading_rad");
  section.Done();
  const Eigen::Vector3d& size = obstacle.size_m;
  const bool round = size.x() == size.y() && (obstacle.shape == Shape::kCylinder || size.y() == size.z());
  if (!section.Wrong("") && obstacle.shape != Shape::kBox && !round)
    section.Fail("size_m",
                 std::string("expected ") +
                     (obstacle.shape == Shape::kSphere ? "the diameter of the sphere three times"
                                                       : "the diameter of the cylinder twice, then its height") +
                     ", got [" + ShortestFloat(size.x()) + ", " + ShortestFloat(size.y()) + ", " +
                     ShortestFloat(size.z()) + "]");
  return obstacle;
}

RotorFailure ReadRotorFailure(Section& section, int agents) {
  RotorFailure failure;
  failure.agent = static_cast<int>(section.Integer("agent", 1, agents > 0 ? agents : 10000));
  failure.rotor = static_cast<int>(section.Integer("rotor"));
  failure.at_s = section.Number("at_s");
  failure.remaining = section.Number("remaining");
  section.Done();
  return failure;
}

}  // namespace

std::span<const Key> PhysicsKeys() { return kPhysicsKeys; }

WindConfig ReadWind(Section wind) {
  WindConfig config;
  config.mean_m_per_s = wind.Vector3("mean_m_per_s");
  config.gust_std_m_per_s = wind.Number("gust_std_m_per_s");
  config.gust_time_s = wind.Number("gust_time_s");
  wind.Done();
  return config;
}

PhysicsConfig ReadPhysics(Section& physics, int agents) {
  PhysicsConfig config;
  config.rate_hz = static_cast<int>(physics.Integer("rate_hz"));
  config.gravity_m_per_s2 = physics.Number("gravity_m_per_s2");
  config.collisions = physics.Boolean("collisions");
  config.ground = physics.Boolean("ground");
  config.wind = ReadWind(physics.Child("wind"));
  for (Section& obstacle : FewTables(physics, "obstacles", kMaxObstacles))
    config.obstacles.push_back(ReadObstacle(obstacle));
  if (physics.Wrong("obstacles")) config.obstacles.clear();  // or agents inside a wrong one would be reported, too
  for (Section& failure : FewTables(physics, "rotor_failures", kMaxFailures))
    config.rotor_failures.push_back(ReadRotorFailure(failure, agents));
  physics.Done();
  return config;
}

}  // namespace mascot
