#include "orchestrator/recording/raw_rows.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "bus/wire.h"
#include "orchestrator/recording/row_codec.h"

namespace mascot {

RawRows::RawRows(const std::string& path, int agents, int rate_hz)
    : path_(path), rate_hz_(rate_hz), reader_(path), row_(agents), next_(reader_.Next()) {}

void RawRows::Clear() {
  row_.clock.clear();
  row_.events.clear();
  for (auto* samples : {&row_.states, &row_.commands, &row_.messages, &row_.actions})
    for (Row::Bytes& sample : *samples) sample.clear();
}

std::int64_t RawRows::TickOf(const McapContents::Message& sample) const {
  const auto tick = static_cast<std::int64_t>(std::llround(static_cast<double>(sample.log_time) * 1e-9 * rate_hz_));
  if (StampNs(tick, rate_hz_) != sample.log_time)
    throw std::runtime_error(path_ + ": a sample at " + std::to_string(sample.log_time) + " ns, which is no tick");
  return tick;
}

void RawRows::Take(const McapContents::Message& sample) {
  const auto topic = Topic::Parse(reader_.contents().channels.at(sample.channel).topic);
  if (!topic || !topic->traits().is_recorded) return;
  if (topic->kind == TopicKind::kEvent)
    row_.events.push_back(sample.data);
  else if (!topic->traits().per_agent || std::cmp_less_equal(topic->agent, row_.states.size()))
    SampleOf(row_, *topic) = sample.data;
}

const Row* RawRows::Next() {
  if (next_ == nullptr) return nullptr;
  Clear();
  row_.tick = TickOf(*next_);
  const std::uint64_t time_ns = next_->log_time;
  for (; next_ != nullptr && next_->log_time == time_ns; next_ = reader_.Next()) Take(*next_);
  return &row_;
}

}  // namespace mascot
