#pragma once

#include <cstdint>
#include <string>

#include "base/enum_names.h"

namespace mascot {

/// Where a vehicle is in its flight, in this order.
enum class FlightPhase {
  kAbsent,     ///< nothing has been heard of it
  kFound,      ///< it says where it is
  kStreaming,  ///< it gets set-points, and is asked to follow them
  kArmed,      ///< it is armed and follows, as its status says
  kTakingOff,  ///< on its way to its agent's start
  kReady,      ///< it holds there
  kFlying,     ///< its agent flies it
  kLanding,
  kLanded,  ///< on the ground, and disarmed
  kLost     ///< nothing is sent to it any more: its autopilot decides
};
inline constexpr EnumNames<FlightPhase, 10> kFlightPhases({{FlightPhase::kAbsent, "absent"},
                                                           {FlightPhase::kFound, "found"},
                                                           {FlightPhase::kStreaming, "streaming"},
                                                           {FlightPhase::kArmed, "armed"},
                                                           {FlightPhase::kTakingOff, "taking off"},
                                                           {FlightPhase::kReady, "ready"},
                                                           {FlightPhase::kFlying, "flying"},
                                                           {FlightPhase::kLanding, "landing"},
                                                           {FlightPhase::kLanded, "landed"},
                                                           {FlightPhase::kLost, "lost"}});

/// Something that has happened to a vehicle.
struct VehicleNews {
  int agent = 0;
  FlightPhase phase = FlightPhase::kAbsent;  ///< then
  std::string words = {};                    ///< for people: "landing: its battery is at 12 %"
};

}  // namespace mascot
