#include "orchestrator/recording/indexed_rows.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bus/wire.h"
#include "experiment/toml/section.h"
#include "orchestrator/recording/row_codec.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxLoaded = 4;  // chunks

std::unique_ptr<McapIndex> OpenIndex(const std::string& path) try {
  return std::make_unique<McapIndex>(path);
} catch (const std::exception& error) {
  throw ConfigError({error.what()});
}

bool BelongsToRows(const Topic& topic, int agents) {
  if (!topic.traits().per_agent) return topic.kind == TopicKind::kEvent;
  return topic.traits().is_recorded && topic.agent >= 1 && topic.agent <= agents;
}

}  // namespace

IndexedRows::IndexedRows(const std::string& run)
    : path_(FindRecording(run)),
      index_(OpenIndex(path_)),
      contents_(WithConfig(index_->contents(), path_)),
      rows_(RowsIn(contents_, path_)),
      row_(rows_.plan.agents),
      before_(rows_.plan.agents) {
  for (const auto& [id, channel] : contents_.channels)
    if (const auto topic = Topic::Parse(channel.topic); topic && BelongsToRows(*topic, rows_.plan.agents))
      topics_[id] = *topic;
}

const IndexedRows::Samples& IndexedRows::Load(std::size_t chunk) {
  const auto known = std::ranges::find(loaded_, chunk, &Loaded::chunk);
  if (known != loaded_.end()) {
    std::rotate(loaded_.begin(), known, known + 1);
    return loaded_.front().samples;
  }
  Loaded loaded{.chunk = chunk, .samples = {}};
  index_->ReadChunk(index_->chunks()[chunk], [&](const McapContents::Message& sample) {
    if (topics_.contains(sample.channel)) loaded.samples.push_back(sample);
  });
  std::ranges::stable_sort(loaded.samples, {}, &McapContents::Message::log_time);
  if (loaded_.size() == kMaxLoaded) loaded_.pop_back();
  loaded_.push_front(std::move(loaded));
  return loaded_.front().samples;
}

/// Puts the samples of a tick into `row`, which keeps its capacity.
void IndexedRows::Collect(std::int64_t tick, Row& row) {
  row.tick = tick;
  row.events.clear();
  for (auto* samples : {&row.states, &row.commands, &row.messages, &row.actions})
    for (Row::Bytes& sample : *samples) sample.clear();
  const std::uint64_t time_ns = StampNs(tick, rows_.plan.rate_hz);
  const auto& chunks = index_->chunks();
  for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
    if (time_ns < chunks[chunk].first_ns || time_ns > chunks[chunk].last_ns) continue;
    const Samples& samples = Load(chunk);
    auto sample = std::ranges::lower_bound(samples, time_ns, {}, &McapContents::Message::log_time);
    for (; sample != samples.end() && sample->log_time == time_ns; ++sample) {
      const Topic& topic = topics_.at(sample->channel);
      if (topic.kind == TopicKind::kEvent)
        row.events.push_back(sample->data);
      else
        SampleOf(row, topic).assign(sample->data.begin(), sample->data.end());
    }
  }
}

void IndexedRows::HoldCommands(std::int64_t tick) {
  const auto is_missing = [](const Row::Bytes& command) { return command.empty(); };
  const std::int64_t first = std::max<std::int64_t>(0, tick - rows_.plan.rate_hz);
  for (std::int64_t k = tick - 1; k >= first && std::ranges::any_of(row_.commands, is_missing); --k) {
    Collect(k, before_);
    for (std::size_t i = 0; i < row_.commands.size(); ++i)
      if (row_.commands[i].empty()) row_.commands[i] = before_.commands[i];
  }
}

void IndexedRows::Require(const Row::Bytes& sample, const Topic& topic) const {
  if (sample.empty())
    throw std::runtime_error(path_ + ": tick " + std::to_string(row_.tick) + " has no " + topic.Name());
}

void IndexedRows::Read(std::int64_t at, DecodedRow& row) {
  const std::int64_t tick = ticks().TickOf(ticks().RowAt(at));
  Collect(tick, row_);
  if (has_commands() && rows_.plan.realtime) HoldCommands(tick);
  for (std::size_t i = 0; i < row_.states.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    Require(row_.states[i], Topic::State(id));
    if (has_commands() && rows_.plan.IsInEveryRow(Topic::Command(id))) Require(row_.commands[i], Topic::Command(id));
  }
  std::ranges::fill(row.commands, Command());
  try {
    Decode(row_, row);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path_ + ": " + error.what());
  }
}

std::vector<IndexedRows::EventAt> IndexedRows::Events() {
  std::vector<EventAt> events;
  const auto& chunks = index_->chunks();
  for (const auto& [id, topic] : topics_) {
    if (topic.kind != TopicKind::kEvent) continue;
    for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
      if (!std::ranges::binary_search(chunks[chunk].channels, id)) continue;
      for (const McapContents::Message& sample : Load(chunk)) {
        if (sample.channel != id) continue;
        mascot_msgs::msg::Event event;
        Deserialize(sample.data, event);
        const auto tick = static_cast<std::int64_t>(event.tick());
        if (tick <= ticks().last()) events.push_back({tick, static_cast<int>(event.number()), event.toml()});
      }
    }
  }
  return events;
}

}  // namespace mascot
