#pragma once

#include <string>

namespace mascot {

/// Which program this is: "0.2.0, build 3f0c...", the version and the identity that the linker has given it. Equal
/// texts: equal programs.
std::string BuildText();

}  // namespace mascot
