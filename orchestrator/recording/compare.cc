#include "orchestrator/recording/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bus/wire.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/recording/sample_fields.h"

namespace mascot {
namespace {

/// "/agent_2/state of t = 0.57 s"
std::string Described(const McapReader& reader, const McapContents::Message& message) {
  return fmt::format("{} of t = {} s", reader.contents().channels.at(message.channel).topic,
                     static_cast<double>(message.log_time) / 1e9);
}

}  // namespace

Comparison::Comparison(const std::string& recording, const RecordingPlan& plan, const RecordedTicks& ticks,
                       const Experiment& experiment)
    : reader_(recording), plan_(plan), recorded_(ticks) {
  for (const Topic& topic : plan_.topics) names_.push_back(topic.Name());
  sent_.resize(names_.size());
  if (plan_.ros_types) ros_ = std::make_unique<RosRows>(experiment);
}

void Comparison::Add(const FlownRow& row) {
  bool first = true;
  const bool has_row = recorded_.Has(row.tick());
  if (!has_row && row.decoded().events.empty()) {
    if (!over_) ++ticks_;
    return;
  }
  const Row& bytes = row.bytes();
  if (ros_ && has_row) ros_->SetRow(row);
  for (std::size_t index = 0; index < plan_.topics.size(); ++index) {
    const Topic& topic = plan_.topics[index];
    const auto add = [&](const Row::Bytes& sample) {
      if (sample.empty()) return;  // nothing was sent
      AddSample(index, row.tick(), sent_[index]++, sample, first);
      first = false;
    };
    if (topic.kind == TopicKind::kEvent)
      std::ranges::for_each(bytes.events, add);
    else if (has_row)
      add(IsOfRosTypes(topic) ? ros_->Message(topic) : SampleOf(bytes, topic));
  }
  if (over_) return;
  ++ticks_;
  rows_ += has_row;
}

void Comparison::AddSample(std::size_t index, std::int64_t tick, std::int64_t sequence, const Row::Bytes& flown,
                           bool first_of_tick) {
  if (over_) return;
  const auto place = [&] {
    return fmt::format("{} at tick {} (t = {} s)", names_[index], tick, static_cast<double>(tick) / plan_.rate_hz);
  };
  const McapContents::Message* recorded = reader_.Next();
  if (recorded == nullptr) {
    if (!first_of_tick && LossOf(reader_.contents()).empty()) Differ(place() + " is missing: the recording ends there");
    over_ = true;
    return;
  }
  if (reader_.contents().channels.at(recorded->channel).topic != names_[index] ||
      recorded->log_time != StampNs(tick, plan_.rate_hz))
    Differ(place() + " is missing: the recording has " + Described(reader_, *recorded) + " there");
  if (recorded->sequence != static_cast<std::uint32_t>(sequence))
    Differ(fmt::format("{} has sequence number {} in the recording, {} flown", place(), recorded->sequence, sequence));
  if (const auto difference = FirstDifference(plan_.topics[index].kind, recorded->data, flown))
    Differ(fmt::format("{}: {} is {} in the recording, {} flown", place(), difference->field, difference->first,
                       difference->second));
  ++messages_;
}

void Comparison::Finish() {
  if (over_) return;
  over_ = true;
  if (const McapContents::Message* more = reader_.Next())
    difference_ =
        fmt::format("the recording goes on after tick {}, the last, with {}", ticks_ - 1, Described(reader_, *more));
}

void Comparison::Differ(const std::string& how) {
  over_ = true;
  difference_ = how;
  throw std::runtime_error("the run differs from its recording: " + how);
}

}  // namespace mascot
