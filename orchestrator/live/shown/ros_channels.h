#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "idl/topics.h"
#include "orchestrator/live/server/foxglove.h"
#include "orchestrator/live/shown/ui_channels.h"
#include "orchestrator/recording/row_codec.h"

namespace mascot {

/// The channels of a run that tools of ROS 2 read, in cdr: /tf (world to agent_<id>), /scene (markers: bodies, numbers,
/// trails, edges of the graph, obstacles), and the run's own recorded topics: of each tick, and its events. No clock,
/// no socket.
class RosChannels {
 public:
  /// Every how many rows /scene holds all markers; in between, if there are few, it holds the edges alone.
  static constexpr int kRowsPerScene = 30;
  static constexpr std::size_t kTopicsBefore = 2;  ///< /tf and /scene come before the run's own topics

  explicit RosChannels(const Experiment& experiment);
  ~RosChannels();
  RosChannels(const RosChannels&) = delete;
  RosChannels& operator=(const RosChannels&) = delete;

  /// All channels, in the order in which Message() counts them.
  std::vector<Foxglove::Channel> channels() const;
  /// Goes on to another row, which must outlive the calls of Message().
  void SetRow(const ShownRow& row);
  /// The message of a channel about the row; empty: there is none.
  std::string Message(std::size_t channel);
  /// The channel of events, of which Message() has none.
  std::size_t event_channel() const { return kTopicsBefore + topics_.size(); }
  /// The message of that channel about an event.
  std::string Message(const ShownEvent& event) const;
  /// The message that a client needs when it subscribes to a channel.
  std::string FirstMessage(std::size_t channel);

 private:
  class Scene;
  std::string Transforms() const;

  const Experiment& experiment_;
  std::vector<Topic> topics_;  // after /tf and /scene
  const ShownRow* row_ = nullptr;
  RowEncoder encoder_;
  const Row* bytes_ = nullptr;  // the row as recorded, once it has been asked for
  std::unique_ptr<Scene> scene_;
};

}  // namespace mascot
