// The time at which tests start that make up the time: the objects that they test have no clock, and are told the time.
#pragma once

#include <chrono>

namespace mascot {

inline constexpr std::chrono::steady_clock::time_point kT0{std::chrono::seconds(1000)};

}  // namespace mascot
