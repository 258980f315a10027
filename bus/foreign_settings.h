#pragma once

#include <span>
#include <string_view>

namespace mascot {

/// Removes what users of ROS 2 and of Fast DDS have set for their own programs: the variables of ForeignSettings(), and
/// a file DEFAULT_FASTRTPS_PROFILES.xml in the current folder. Fast DDS reads them behind our back, and a discovery
/// server or a profile that the processes of a run do not share keeps them from finding each other. Each program calls
/// it first of all, because it changes the environment, which no other thread may read meanwhile. Children inherit the
/// result.
void ForgetForeignSettings();

/// The names of these variables; a name that ends with '*' stands for all names that begin with the rest.
std::span<const std::string_view> ForeignSettings();

}  // namespace mascot
