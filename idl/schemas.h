#pragma once

#include <span>
#include <string>
#include <string_view>

#include "idl/topics.h"

namespace mascot {

/// The schema of a message type, for recordings and ROS 2 tools.
struct TypeSchema {
  std::string_view name;       ///< "mascot_msgs/msg/AgentState"
  std::string_view text;       ///< encoding "ros2msg": the .msg text, then those of all types it contains
  std::string_view type_hash;  ///< "RIHS01_<64 hex digits>", REP-2016
};

/// All types of mascot_msgs, rosgraph_msgs/msg/Clock, and those of ROS 2 with which tools draw a run.
std::span<const TypeSchema> Schemas();
/// The schema of the type `name`. Throws std::out_of_range if there is none.
const TypeSchema& SchemaOf(std::string_view name);
/// The schema of the samples on topics of this kind.
const TypeSchema& SchemaOf(TopicKind kind);

/// The value of `offered_qos_profiles` in a recording, for a topic that is written reliable, keep last `depth`,
/// volatile or, for readers that join later, transient local: YAML with the integers of rmw/types.h, which every ROS 2
/// release reads.
std::string OfferedQos(const TopicTraits& topic);

}  // namespace mascot
