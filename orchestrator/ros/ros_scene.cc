#include "orchestrator/ros/ros_scene.h"

#include <cmath>
#include <utility>

#include "idl/topics.h"

namespace mascot {
namespace {

using visualization_msgs::msg::Marker;
using Markers = visualization_msgs::msg::MarkerArray;

/// Values of Marker::type.
enum MarkerType : std::int32_t { kCube = 1, kSphere = 2, kCylinder = 3, kLineStrip = 4, kLineList = 5, kText = 9 };

constexpr double kLineWidth_m = 0.03, kTextHeight_m = 0.3;

struct Colour {
  float r, g, b, a = 1;
};
// Okabe and Ito's palette, as in the pictures.
constexpr Colour kBlue{0.0f, 0.447f, 0.698f}, kGreen{0.0f, 0.62f, 0.451f}, kVermilion{0.835f, 0.369f, 0.0f},
    kOrange{0.902f, 0.624f, 0.0f}, kGrey{0.6f, 0.6f, 0.6f, 0.6f};

geometry_msgs::msg::Point ToPoint(const Eigen::Vector3d& p) {
  geometry_msgs::msg::Point point;
  point.x(p.x());
  point.y(p.y());
  point.z(p.z());
  return point;
}

/// A marker that stands until another of the same name and number replaces it.
Marker MakeMarker(const char* name, std::int32_t id, MarkerType type, const Colour& colour,
                  const std_msgs::msg::Header& header) {
  Marker marker;
  marker.header(header);
  marker.ns(name);
  marker.id(id);
  marker.type(type);
  marker.pose().orientation().w(1);
  marker.color().r(colour.r);
  marker.color().g(colour.g);
  marker.color().b(colour.b);
  marker.color().a(colour.a);
  return marker;
}

Marker MakeLines(const char* name, std::int32_t id, MarkerType type, const Colour& colour,
                 const std_msgs::msg::Header& header) {
  Marker marker = MakeMarker(name, id, type, colour, header);
  marker.scale().x(kLineWidth_m);
  return marker;
}

MarkerType TypeOf(Shape shape) { return shape == Shape::kBox ? kCube : shape == Shape::kSphere ? kSphere : kCylinder; }

void AddBody(const AgentConfig& agent, std::uint64_t time_ns, Markers& to) {
  const std_msgs::msg::Header header = HeaderOf(time_ns, AgentName(agent.id));
  const Colour& colour = agent.law.leader == agent.id ? kOrange : kBlue;
  const bool has_rotors = agent.traits().has_airframe;
  Marker body = MakeMarker("bodies", agent.id, has_rotors ? kCube : kSphere, colour, header);
  body.scale(ToVector3(agent.size_m()));
  body.frame_locked(true);
  if (has_rotors) {
    body.color().a(0.3f);  // the box that collides; the arms are inside
    Marker arms = MakeLines("arms", agent.id, kLineList, colour, header);
    arms.frame_locked(true);
    for (const double d : {agent.airframe.arm_m, -agent.airframe.arm_m})
      for (const Eigen::Vector3d& end : {Eigen::Vector3d(d, 0, 0), Eigen::Vector3d(0, d, 0)})
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), end}) arms.points().push_back(ToPoint(p));
    to.markers().push_back(std::move(arms));
  }
  to.markers().push_back(std::move(body));
  Marker number = MakeMarker("numbers", agent.id, kText, kGrey, header);
  number.scale().z(kTextHeight_m);
  number.pose().position().z(agent.size_m().z() / 2 + kTextHeight_m);
  number.frame_locked(true);
  number.text(std::to_string(agent.id));
  to.markers().push_back(std::move(number));
}

void AddObstacle(const Obstacle& obstacle, std::int32_t id, std::uint64_t time_ns, Markers& to) {
  Marker marker = MakeMarker("obstacles", id, TypeOf(obstacle.shape), kGrey, HeaderOf(time_ns, kWorldFrame));
  marker.pose().position(ToPoint(obstacle.p_W));
  marker.pose().orientation().w(std::cos(obstacle.heading_rad / 2));
  marker.pose().orientation().z(std::sin(obstacle.heading_rad / 2));
  marker.scale(ToVector3(obstacle.size_m));
  to.markers().push_back(std::move(marker));
}

/// One marker for all edges of each state, so that none is left over from an earlier row.
void AddEdgeMarkers(const Experiment& experiment, const SceneMoment& now, Markers& to) {
  constexpr std::pair<EdgeNow::State, Colour> kColours[] = {{EdgeNow::State::kHeard, kGreen},
                                                            {EdgeNow::State::kLost, kVermilion},
                                                            {EdgeNow::State::kOutOfRange, kGrey},
                                                            {EdgeNow::State::kNothingYet, kGrey}};
  const std_msgs::msg::Header header = HeaderOf(now.time_ns, kWorldFrame);
  const auto at = [&](int id) { return ToPoint(now.motions[static_cast<std::size_t>(id - 1)].p_WB); };
  std::int32_t id = 0;
  for (const auto& [state, colour] : kColours) {
    Marker lines = MakeLines("edges", ++id, kLineList, colour, header);
    std::size_t edge = 0;
    for (int hearer = 1; hearer <= experiment.size() && edge < now.edges.size(); ++hearer)
      for (const Graph::Neighbour& heard : experiment.graph.HeardBy(hearer))
        if (now.edges[edge++].state == state) {
          lines.points().push_back(at(hearer));
          lines.points().push_back(at(heard.id));
        }
    to.markers().push_back(std::move(lines));
  }
}

}  // namespace

geometry_msgs::msg::Vector3 ToVector3(const Eigen::Vector3d& v) {
  geometry_msgs::msg::Vector3 vector;
  vector.x(v.x());
  vector.y(v.y());
  vector.z(v.z());
  return vector;
}

std_msgs::msg::Header HeaderOf(std::uint64_t time_ns, const std::string& frame) {
  std_msgs::msg::Header header;
  header.stamp().sec(static_cast<std::int32_t>(time_ns / 1'000'000'000));
  header.stamp().nanosec(static_cast<std::uint32_t>(time_ns % 1'000'000'000));
  header.frame_id(frame);
  return header;
}

tf2_msgs::msg::TFMessage TransformsOf(const SceneMoment& now) {
  const std_msgs::msg::Header header = HeaderOf(now.time_ns, kWorldFrame);
  tf2_msgs::msg::TFMessage message;
  int id = 0;
  for (const Motion& motion : now.motions) {
    geometry_msgs::msg::TransformStamped transform;
    transform.header(header);
    transform.child_frame_id(AgentName(++id));
    transform.transform().translation(ToVector3(motion.p_WB));
    transform.transform().rotation().x(motion.q_WB.x());
    transform.transform().rotation().y(motion.q_WB.y());
    transform.transform().rotation().z(motion.q_WB.z());
    transform.transform().rotation().w(motion.q_WB.w());
    message.transforms().push_back(std::move(transform));
  }
  return message;
}

void RosScene::AddToTrails(std::span<const Motion> motions) {
  for (std::size_t i = 0; i < trails_.size(); ++i) {
    trails_[i].push_back(motions[i].p_WB);
    if (trails_[i].size() > trail_points_) trails_[i].pop_front();
  }
}

void RosScene::ClearTrails() {
  for (auto& trail : trails_) trail.clear();
}

Markers RosScene::Edges(const SceneMoment& now) const {
  Markers markers;
  AddEdgeMarkers(experiment_, now, markers);
  return markers;
}

Markers RosScene::All(const SceneMoment& now) const {
  Markers markers = Edges(now);
  for (const AgentConfig& agent : experiment_.agents) {
    AddBody(agent, now.time_ns, markers);
    Marker trail = MakeLines("trails", agent.id, kLineStrip, kGrey, HeaderOf(now.time_ns, kWorldFrame));
    for (const Eigen::Vector3d& p : trails_[static_cast<std::size_t>(agent.id - 1)])
      trail.points().push_back(ToPoint(p));
    markers.markers().push_back(std::move(trail));
  }
  std::int32_t id = 0;
  for (const Obstacle& obstacle : experiment_.physics.obstacles) AddObstacle(obstacle, ++id, now.time_ns, markers);
  return markers;
}

}  // namespace mascot
