#pragma once

#include <string>

#include "base/motion.h"

namespace mascot {

/// Why nothing can be flown by a motion that a vehicle says it has, in words for people: a position, velocity or
/// turning that is no number or beyond all reason, a quaternion that is no orientation. Empty: it is good, and q_WB has
/// a norm of about 1, as whoever sends floats has it.
std::string WhyNotMeasured(const Motion& motion);

}  // namespace mascot
