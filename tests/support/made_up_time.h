// The time at which tests start that make up the time: what they test is told it, and has no clock.
#pragma once

#include <chrono>

namespace mascot {

inline constexpr std::chrono::steady_clock::time_point kT0{std::chrono::seconds(1000)};

}  // namespace mascot
