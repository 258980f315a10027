#pragma once

#include <cstdint>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/ros/ros_scene.h"
#include "orchestrator/ros/scene_rhythm.h"

namespace mascot {

/// The pose of an agent's body in W, and its twist in the frame of the body, as nav_msgs/Odometry wants it. Both are
/// true, so that their covariances are 0.
nav_msgs::msg::Odometry OdometryOf(int id, const Motion& motion, std::uint64_t time_ns);

/// The messages of a recording in standard types of ROS 2 (record.ros_types), in cdr: /tf, /scene, /agent_<id>/odom.
/// The same rows give the same bytes.
class RosMessages {
 public:
  using Bytes = std::vector<std::uint8_t>;

  explicit RosMessages(const Experiment& experiment);

  /// Goes on to the next row, whose spans must live as long as messages of it are asked for.
  void SetRow(std::int64_t tick, const SceneMoment& now);
  // The messages of the row, each valid until the next call of the same function.
  const Bytes& Transforms();
  const Bytes& Odometry(int id);
  const Bytes& Scene();  ///< empty: this row has none

 private:
  SceneRhythm rhythm_;
  RosScene scene_;
  std::int64_t tick_ = -1;
  SceneMoment now_;
  Bytes transforms_, odometry_, markers_;
};

}  // namespace mascot
