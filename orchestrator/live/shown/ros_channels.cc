#include "orchestrator/live/shown/ros_channels.h"

#include <utility>

#include "bus/wire.h"
#include "idl/schemas.h"
#include "orchestrator/live/shown/shown_moment.h"
#include "orchestrator/recording/topic_filter.h"
#include "orchestrator/ros/ros_scene.h"

namespace mascot {
namespace {

using ScenePubSub = visualization_msgs::msg::MarkerArrayPubSubType;

constexpr std::size_t kTfChannel = 0, kSceneChannel = 1;
constexpr std::size_t kFewEdges = 2000;
/// A trail has a point for every so many rows: at 30 rows a second, one point a fifth of a second.
constexpr int kRowsPerTrailPoint = 6;
/// Agents that are seen again after more simulated time than this have a new trail.
constexpr int kLongestTrailStep_s = 8;

Foxglove::Channel CdrChannel(const std::string& topic, const TypeSchema& schema) {
  return {topic, "cdr", {std::string(schema.name), "ros2msg", std::string(schema.text)}};
}

}  // namespace

/// The markers, and when they were sent last.
class RosChannels::Scene {
 public:
  explicit Scene(const Experiment& experiment) : experiment_(experiment), markers_(experiment) {}

  void SetRow(const ShownRow& row) {
    ++rows_;
    if (const std::int64_t by = row.tick - std::exchange(tick_, row.tick); by < 0 || by > trail_ticks_)
      markers_.ClearTrails();  // a viewer sought another place of a recording
    if (rows_ % kRowsPerTrailPoint == 0) markers_.AddToTrails(row.decoded.motions);
  }
  std::string Message(const ShownRow& row) const {
    if (rows_ % kRowsPerScene == 0) return All(row);
    if (experiment_.graph.edges() > kFewEdges) return {};
    visualization_msgs::msg::MarkerArray edges = markers_.Edges(MomentOf(experiment_, row));
    return CdrOf<ScenePubSub>(edges);
  }
  std::string All(const ShownRow& row) const {
    visualization_msgs::msg::MarkerArray all = markers_.All(MomentOf(experiment_, row));
    return CdrOf<ScenePubSub>(all);
  }

 private:
  const Experiment& experiment_;
  RosScene markers_;
  const std::int64_t trail_ticks_ = std::int64_t{kLongestTrailStep_s} * experiment_.control.rate_hz;
  std::int64_t rows_ = 0, tick_ = 0;
};

RosChannels::RosChannels(const Experiment& experiment)
    : experiment_(experiment), encoder_(experiment), scene_(std::make_unique<Scene>(experiment)) {
  const auto add = [&](const Topic& topic) {
    if (IsRecorded(experiment.record.topics, topic)) topics_.push_back(topic);
  };
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.takes_actions) add(Topic::Action(agent.id));
    add(Topic::Command(agent.id));
    if (agent.sends_messages) add(Topic::Message(agent.id));
    add(Topic::State(agent.id));
  }
  topics_.push_back(Topic::Clock());
}

RosChannels::~RosChannels() = default;

std::vector<Foxglove::Channel> RosChannels::channels() const {
  std::vector<Foxglove::Channel> channels{CdrChannel("/tf", SchemaOf("tf2_msgs/msg/TFMessage")),
                                          CdrChannel("/scene", SchemaOf("visualization_msgs/msg/MarkerArray"))};
  for (const Topic& topic : topics_) channels.push_back(CdrChannel(topic.Name(), SchemaOf(topic.kind)));
  channels.push_back(CdrChannel(Topic::Event().Name(), SchemaOf(TopicKind::kEvent)));
  return channels;
}

void RosChannels::SetRow(const ShownRow& row) {
  row_ = &row;
  bytes_ = nullptr;
  scene_->SetRow(row);
}

std::string RosChannels::Transforms() const {
  tf2_msgs::msg::TFMessage message = TransformsOf(MomentOf(experiment_, *row_));
  return CdrOf<tf2_msgs::msg::TFMessagePubSubType>(message);
}

std::string RosChannels::Message(std::size_t channel) {
  if (channel == kTfChannel) return Transforms();
  if (channel == kSceneChannel) return scene_->Message(*row_);
  if (channel == event_channel()) return {};
  if (bytes_ == nullptr) bytes_ = &encoder_.Encode(row_->tick, row_->decoded);
  const Row::Bytes& bytes = SampleOf(*bytes_, topics_[channel - kTopicsBefore]);
  return {bytes.begin(), bytes.end()};
}

std::string RosChannels::Message(const ShownEvent& event) const {
  mascot_msgs::msg::Event sample;
  ToWire(event.tick, experiment_.control.rate_hz, static_cast<int>(event.number), event.toml, sample);
  Row::Bytes bytes;
  Serialize(sample, bytes);
  return {bytes.begin(), bytes.end()};
}

std::string RosChannels::FirstMessage(std::size_t channel) {
  if (channel == kSceneChannel) return scene_->All(*row_);
  return Message(channel);
}

}  // namespace mascot
