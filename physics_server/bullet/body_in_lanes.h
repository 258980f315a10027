#pragma once

#include <cstddef>

#include "base/motion.h"
#include "physics_server/bullet/body.h"
#include "physics_server/lanes/rotor_bodies.h"

namespace mascot {

/// Writes what stays of a body's numbers, as body `i` of `bodies`.
void PutConstants(const Body& body, double dt_s, double gravity_m_per_s2, RotorBodies& bodies, std::size_t i);

/// Moves the numbers of a body out of Bullet, and back.
void MoveOutOfBullet(Body& body, RotorBodies& bodies, std::size_t i);
void MoveIntoBullet(const RotorBodies& bodies, std::size_t i, Body& body);

/// The motion of a body in RotorBodies now. a_WB is left at 0.
Motion Now(const RotorBodies& bodies, std::size_t i);

}  // namespace mascot
