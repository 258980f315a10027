#pragma once

#include <viewPubSubTypes.h>

#include <Eigen/Core>
#include <deque>
#include <string>
#include <vector>

#include "bus/cdr.h"
#include "experiment/experiment.h"
#include "orchestrator/live/shown/ui_channels.h"

namespace mascot {

/// Frame in which positions are given: W.
inline constexpr const char* kWorldFrame = "world";

/// The bytes of a sample of any size: encapsulation, then CDR with zeroed padding.
template <class PubSub>
std::string CdrOf(typename PubSub::type& sample) {
  ZeroPadded<PubSub> type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  if (!type.serialize(&sample, &payload)) throw std::logic_error("a sample did not fit its own type");
  return {reinterpret_cast<const char*>(payload.data), payload.length};
}

std_msgs::msg::Header HeaderOf(std::uint64_t time_ns, const std::string& frame);

/// The places of the agents: from kWorldFrame to a frame for each agent, which has the agent's name.
tf2_msgs::msg::TFMessage TransformsOf(const ShownRow& row, std::uint64_t time_ns);

/// A run as markers of RViz. Bodies and numbers are in the frames of their agents, which /tf moves.
class RosScene {
 public:
  explicit RosScene(const Experiment& experiment) : experiment_(experiment), trails_(experiment.agents.size()) {}
  /// Adds the places of the agents to their trails.
  void AddToTrails(const ShownRow& row);
  void ClearTrails();
  /// All markers.
  visualization_msgs::msg::MarkerArray All(const ShownRow& row, std::uint64_t time_ns) const;
  /// The edges alone.
  visualization_msgs::msg::MarkerArray Edges(const ShownRow& row, std::uint64_t time_ns) const;

 private:
  const Experiment& experiment_;
  std::vector<std::deque<Eigen::Vector3d>> trails_;  // by id - 1
};

}  // namespace mascot
