#pragma once

#include <viewPubSubTypes.h>

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "agent/neighbours.h"
#include "base/motion.h"
#include "bus/cdr.h"
#include "experiment/experiment.h"

namespace mascot {

/// A tick of a run, as scenes and transforms show it.
struct SceneMoment {
  std::uint64_t time_ns = 0;
  std::span<const Motion> motions;  ///< by id - 1
  /// In increasing order of hearer, then of heard; empty: no edges are shown.
  std::span<const EdgeNow> edges = {};
};

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

geometry_msgs::msg::Vector3 ToVector3(const Eigen::Vector3d& v);
std_msgs::msg::Header HeaderOf(std::uint64_t time_ns, const std::string& frame);

/// The places of the agents: from kWorldFrame to a frame for each agent, which has the agent's name.
tf2_msgs::msg::TFMessage TransformsOf(const SceneMoment& now);

/// Points of a whole trail.
inline constexpr std::size_t kTrailPoints = 200;

/// A run as markers of RViz. Bodies and numbers are in the frames of their agents, which /tf moves.
class RosScene {
 public:
  explicit RosScene(const Experiment& experiment, std::size_t trail_points = kTrailPoints)
      : experiment_(experiment), trail_points_(trail_points), trails_(experiment.agents.size()) {}
  /// Adds the places of the agents to their trails.
  void AddToTrails(std::span<const Motion> motions);
  void ClearTrails();
  /// All markers.
  visualization_msgs::msg::MarkerArray All(const SceneMoment& now) const;
  /// The edges alone.
  visualization_msgs::msg::MarkerArray Edges(const SceneMoment& now) const;

 private:
  const Experiment& experiment_;
  std::size_t trail_points_;
  std::vector<std::deque<Eigen::Vector3d>> trails_;  // by id - 1
};

}  // namespace mascot
