#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mascot {

/// What ROS 2 tools and recordings need to know of a message type.
struct TypeSchema {
  std::string_view name;       ///< "mascot_msgs/msg/AgentState"
  std::string_view text;       ///< "ros2msg": the .msg text, then those of all types it is made of
  std::string_view type_hash;  ///< "RIHS01_<64 hex digits>", REP-2016
};

/// Every type of ours that is on the wire, and rosgraph_msgs/msg/Clock.
std::span<const TypeSchema> Schemas();
/// The row of that name. Throws std::out_of_range if there is none.
const TypeSchema& SchemaOf(std::string_view name);

/// A recording's `offered_qos_profiles` of a topic that we write reliable, volatile, keeping `depth` samples:
/// YAML with the integers of rmw/types.h, which every ROS 2 release reads.
std::string OfferedQos(int depth);

}  // namespace mascot
