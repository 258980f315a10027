#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/enum_names.h"
#include "experiment/toml/section.h"

namespace mascot {

/// Wind, the same for all bodies: a mean and gusts about it. Each component of the gusts is a first-order Gauss-Markov
/// process (the Dryden spectrum's simplest form) with this standard deviation and correlation time.
struct WindConfig {
  Eigen::Vector3d mean_m_per_s = Eigen::Vector3d::Zero();  ///< in W
  double gust_std_m_per_s = 0;
  double gust_time_s = 1;
};

enum class Shape { kBox, kSphere, kCylinder };
inline constexpr EnumNames<Shape, 3> kShapes({{Shape::kBox, "box"},
                                              {Shape::kSphere, "sphere"},
                                              {Shape::kCylinder, "cylinder"}});

/// A solid body that does not move.
struct Obstacle {
  Shape shape = Shape::kBox;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< centre (m)
  /// Full lengths (m). For a sphere its diameter three times; for a cylinder, which stands upright, its diameter twice,
  /// then its height.
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  double heading_rad = 0;  ///< yaw
};

/// A quadrotor's rotor loses thrust at a given time.
struct RotorFailure {
  int agent = 0;
  int rotor = 0;  ///< 1 front, 2 left, 3 back, 4 right
  double at_s = 0;
  double remaining = 0;  ///< fraction of the rotor's thrust and torque that remains, 0..1
};

struct PhysicsConfig {
  int rate_hz = 1000;
  double gravity_m_per_s2 = 9.81;
  bool collisions = true;
  bool ground = true;
  WindConfig wind;
  std::vector<Obstacle> obstacles;
  std::vector<RotorFailure> rotor_failures;
};

/// The keys of [physics].
std::span<const Key> PhysicsKeys();
/// Reads [physics]. `agents` is the number of agents; 0: it is unknown because of a mistake. Mistakes are noted in
/// `physics`. Whether the agent of a rotor failure is a quadrotor is checked later.
PhysicsConfig ReadPhysics(Section& physics, int agents);
/// Reads physics.wind.
WindConfig ReadWind(Section wind);

}  // namespace mascot
