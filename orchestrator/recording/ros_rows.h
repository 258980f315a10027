#pragma once

#include <vector>

#include "experiment/experiment.h"
#include "idl/topics.h"
#include "orchestrator/recording/edge_queue.h"
#include "orchestrator/ros/ros_messages.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// The messages that a recording has of each row in standard types of ROS 2 (record.ros_types).
class RosRows {
 public:
  /// `experiment` must outlive this object.
  explicit RosRows(const Experiment& experiment);

  /// Whether the recording has /scene, which needs edges().
  bool has_scene() const { return has_scene_; }
  /// Where somebody puts the states of edges at each tick at which SceneRhythm::ShowsEdges, before SetRow() of it.
  EdgeQueue& edges() { return edges_; }

  /// Goes on to the next row of the recording, which must outlive the calls of Message().
  void SetRow(const FlownRow& row);
  /// The row's message of this topic, of one of the three kinds; empty: there is none. Valid until the next call.
  const Row::Bytes& Message(const Topic& topic);

 private:
  const Experiment& experiment_;
  const bool has_scene_;
  const SceneRhythm rhythm_;
  RosMessages messages_;
  EdgeQueue edges_;
  std::vector<EdgeNow> edges_now_;
};

/// Whether topics of this kind are those of record.ros_types.
inline bool IsOfRosTypes(const Topic& topic) { return topic.traits().is_for_ros; }

}  // namespace mascot
