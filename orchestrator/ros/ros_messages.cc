#include "orchestrator/ros/ros_messages.h"

#include <algorithm>

#include "idl/topics.h"

namespace mascot {
namespace {

/// Points of all trails together: each message with all markers holds them. Teams of up to 100 have whole trails.
constexpr std::size_t kAllTrailPoints = 20000, kFewestTrailPoints = 2;

std::size_t TrailPointsOf(const Experiment& experiment) {
  return std::clamp(kAllTrailPoints / experiment.agents.size(), kFewestTrailPoints, kTrailPoints);
}

template <class PubSub>
void Put(typename PubSub::type sample, RosMessages::Bytes& bytes) {
  thread_local ZeroPadded<PubSub> type;
  thread_local eprosima::fastrtps::rtps::SerializedPayload_t payload(type.m_typeSize);
  payload.length = 0;
  payload.reserve(type.getSerializedSizeProvider(&sample)());
  if (!type.serialize(&sample, &payload)) throw std::logic_error("a sample did not fit its own type");
  bytes.assign(payload.data, payload.data + payload.length);
}

}  // namespace

nav_msgs::msg::Odometry OdometryOf(int id, const Motion& motion, std::uint64_t time_ns) {
  nav_msgs::msg::Odometry odometry;
  odometry.header(HeaderOf(time_ns, kWorldFrame));
  odometry.child_frame_id(AgentName(id));
  auto& pose = odometry.pose().pose();
  pose.position().x(motion.p_WB.x());
  pose.position().y(motion.p_WB.y());
  pose.position().z(motion.p_WB.z());
  pose.orientation().x(motion.q_WB.x());
  pose.orientation().y(motion.q_WB.y());
  pose.orientation().z(motion.q_WB.z());
  pose.orientation().w(motion.q_WB.w());
  const Eigen::Vector3d v_WB_B = motion.q_WB.conjugate() * motion.v_WB;
  odometry.twist().twist().linear(ToVector3(v_WB_B));
  odometry.twist().twist().angular(ToVector3(motion.w_WB_B));
  return odometry;
}

RosMessages::RosMessages(const Experiment& experiment)
    : rhythm_(experiment), scene_(experiment, TrailPointsOf(experiment)) {}

void RosMessages::SetRow(std::int64_t tick, const SceneMoment& now) {
  tick_ = tick;
  now_ = now;
  if (rhythm_.HasTrailPoint(tick)) scene_.AddToTrails(now.motions);
}

const RosMessages::Bytes& RosMessages::Transforms() {
  Put<tf2_msgs::msg::TFMessagePubSubType>(TransformsOf(now_), transforms_);
  return transforms_;
}

const RosMessages::Bytes& RosMessages::Odometry(int id) {
  Put<nav_msgs::msg::OdometryPubSubType>(OdometryOf(id, now_.motions[static_cast<std::size_t>(id - 1)], now_.time_ns),
                                         odometry_);
  return odometry_;
}

const RosMessages::Bytes& RosMessages::Scene() {
  using Scene = visualization_msgs::msg::MarkerArrayPubSubType;
  markers_.clear();
  const SceneRhythm::Due due = rhythm_.At(tick_);
  if (due == SceneRhythm::Due::kAll) Put<Scene>(scene_.All(now_), markers_);
  if (due == SceneRhythm::Due::kEdges) Put<Scene>(scene_.Edges(now_), markers_);
  return markers_;
}

}  // namespace mascot
