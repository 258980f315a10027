#include "orchestrator/live/shown/ros_view.h"

#include <stdexcept>
#include <utility>

#include "orchestrator/live/shown/shown_moment.h"

namespace mascot {
namespace {

/// A trail has a point for every so many rows that are shown: at 50 rows a second, one point a fifth of a second.
constexpr int kRowsPerPoint = 10;

RosSource::Bytes BytesOf(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

RosView::RosView(const Experiment& experiment, const RunMeter& meter)
    : experiment_(experiment),
      meter_(meter),
      newest_(experiment.size()),
      shown_(experiment.size()),
      scene_(experiment) {}

void RosView::Add(const FlownRow& row) {
  const std::lock_guard lock(mutex_);
  newest_.tick = row.tick();
  newest_.decoded = row.decoded();
  if (experiment_.graph.edges() <= kMaxEdgesShown) meter_.EdgesNow(newest_.edges);
}

void RosView::Fail(const std::string& why) {
  const std::lock_guard lock(mutex_);
  failure_ = why;
}

std::int64_t RosView::TakeNewest() {
  {
    const std::lock_guard lock(mutex_);
    if (!failure_.empty()) throw std::runtime_error(failure_);
    if (newest_.tick <= shown_.tick) return shown_.tick;
    std::swap(newest_, shown_);
  }
  if (rows_++ % kRowsPerPoint == 0) scene_.AddToTrails(shown_.decoded.motions);
  return shown_.tick;
}

RosSource::Bytes RosView::Transforms() const {
  tf2_msgs::msg::TFMessage transforms = TransformsOf(MomentOf(experiment_, shown_));
  return BytesOf(CdrOf<tf2_msgs::msg::TFMessagePubSubType>(transforms));
}

RosSource::Bytes RosView::Scene() const {
  visualization_msgs::msg::MarkerArray all = scene_.All(MomentOf(experiment_, shown_));
  return BytesOf(CdrOf<visualization_msgs::msg::MarkerArrayPubSubType>(all));
}

}  // namespace mascot
