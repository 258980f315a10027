#include "orchestrator/recording/ros_rows.h"

#include "bus/wire.h"
#include "orchestrator/recording/topic_filter.h"

namespace mascot {

RosRows::RosRows(const Experiment& experiment)
    : experiment_(experiment),
      has_scene_(IsRecorded(experiment.record.topics, Topic::Scene())),
      rhythm_(experiment),
      messages_(experiment) {}

void RosRows::SetRow(const FlownRow& row) {
  edges_now_.clear();
  if (has_scene_ && rhythm_.ShowsEdges(row.tick())) edges_now_ = edges_.Take(row.tick());
  messages_.SetRow(row.tick(), {.time_ns = StampNs(row.tick(), experiment_.control.rate_hz),
                                .motions = row.decoded().motions,
                                .edges = edges_now_});
}

const Row::Bytes& RosRows::Message(const Topic& topic) {
  if (topic.kind == TopicKind::kTf) return messages_.Transforms();
  if (topic.kind == TopicKind::kScene) return messages_.Scene();
  return messages_.Odometry(topic.agent);
}

}  // namespace mascot
