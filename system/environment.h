#pragma once

#include <string>

namespace mascot {

/// The value of a variable of the environment; empty if it is not set.
std::string EnvironmentText(const char* name);
/// The path of a program that is in PATH; empty if there is none.
std::string FindInPath(const std::string& program);

}  // namespace mascot
