#pragma once

#include <array>
#include <string_view>

namespace mascot {

/// Names that an experiment file may use for things whose tables live in libraries above this one: the
/// models' in physics_server/models.cc, the transports' in bus/qos.cc. Tests hold them against those tables.
inline constexpr std::array<std::string_view, 4> kModelNames = {"quadrotor", "double_integrator", "single_integrator",
                                                                "unicycle"};
inline constexpr std::array<std::string_view, 3> kTransportNames = {"auto", "udp", "shm"};

}  // namespace mascot
