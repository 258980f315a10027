#pragma once

#include <string>

namespace mascot {

/// The value of a variable of the environment; empty if it is not set.
std::string EnvironmentText(const char* name);

}  // namespace mascot
