#include "experiment/physics.h"

#include <array>

namespace mascot {
namespace {

constexpr double kFarthest_m = 1e6;

WindConfig ReadWind(Section wind) {
  constexpr double kStrongest_m_per_s = 200;
  WindConfig config;
  config.mean_m_per_s =
      wind.Vector3("mean_m_per_s", -kStrongest_m_per_s, kStrongest_m_per_s, Eigen::Vector3d::Zero().eval());
  config.gust_std_m_per_s = wind.Number("gust_std_m_per_s", 0, kStrongest_m_per_s, 0.0);
  config.gust_time_s = wind.Positive("gust_time_s", 1e4, 1.0);
  wind.Done();
  return config;
}

Obstacle ReadObstacle(Section& section) {
  constexpr std::array<std::string_view, 3> kShapes = {"box", "sphere", "cylinder"};
  Obstacle obstacle;
  const std::string shape = section.OneOf("shape", kShapes);
  obstacle.shape = shape == "sphere" ? Shape::kSphere : shape == "cylinder" ? Shape::kCylinder : Shape::kBox;
  obstacle.p_W = section.Vector3("position_m", -kFarthest_m, kFarthest_m);
  obstacle.size_m = section.Vector3("size_m", 1e-3, 1e4);
  obstacle.heading_rad = section.Number("heading_rad", -10, 10, 0.0);
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
  failure.rotor = static_cast<int>(section.Integer("rotor", 1, 4));
  failure.at_s = section.Number("at_s", 0, 1e6);
  failure.remaining = section.Number("remaining", 0, 1, 0.0);
  section.Done();
  return failure;
}

}  // namespace

PhysicsConfig ReadPhysics(Section& physics, int agents) {
  PhysicsConfig config;
  config.rate_hz = static_cast<int>(physics.Integer("rate_hz", 1, 100000, 1000));
  config.gravity_m_per_s2 = physics.Number("gravity_m_per_s2", 0, 100, 9.81);
  config.collisions = physics.Boolean("collisions", true);
  config.ground = physics.Boolean("ground", true);
  config.wind = ReadWind(physics.Child("wind"));
  for (Section& obstacle : physics.Children("obstacles")) config.obstacles.push_back(ReadObstacle(obstacle));
  if (physics.Wrong("obstacles")) config.obstacles.clear();  // who starts inside would only follow from the mistake
  for (Section& failure : physics.Children("rotor_failures"))
    config.rotor_failures.push_back(ReadRotorFailure(failure, agents));
  physics.Done();
  return config;
}

}  // namespace mascot
