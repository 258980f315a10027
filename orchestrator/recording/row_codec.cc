#include "orchestrator/recording/row_codec.h"

#include <fmt/format.h>

#include <stdexcept>

namespace mascot {
namespace {

template <class Message>
std::uint64_t BytesOf(Message sample) {
  Row::Bytes bytes;
  Serialize(sample, bytes);
  return bytes.size();
}

/// `AnyRow` is Row or const Row.
template <class AnyRow>
auto& SampleIn(AnyRow& row, const Topic& topic) {
  const auto agent = static_cast<std::size_t>(topic.agent - 1);
  return topic.kind == TopicKind::kState     ? row.states[agent]
         : topic.kind == TopicKind::kCommand ? row.commands[agent]
         : topic.kind == TopicKind::kMessage ? row.messages[agent]
                                             : row.clock;
}

/// Deserializes a sample of `row`. Throws std::runtime_error with tick and topic if it is none.
template <class Sample>
void DecodeSample(const Row& row, const Topic& topic, Sample& sample) try {
  Deserialize(SampleIn(row, topic), sample);
} catch (const std::runtime_error& error) {
  throw std::runtime_error(fmt::format("tick {}: {}: {}", row.tick, topic.Name(), error.what()));
}

void DecodeEvents(const Row& row, DecodedRow& decoded) try {
  decoded.events.clear();
  mascot_msgs::msg::Event event;
  for (const Row::Bytes& bytes : row.events) {
    Deserialize(bytes, event);
    decoded.events.push_back(
        {static_cast<int>(event.number()), FromWire(event, static_cast<int>(decoded.motions.size()))});
  }
} catch (const std::runtime_error& error) {
  throw std::runtime_error(fmt::format("tick {}: {}: {}", row.tick, Topic::Event().Name(), error.what()));
}

}  // namespace

Row::Bytes& SampleOf(Row& row, const Topic& topic) { return SampleIn(row, topic); }
const Row::Bytes& SampleOf(const Row& row, const Topic& topic) { return SampleIn(row, topic); }

void Decode(const Row& row, DecodedRow& decoded) {
  mascot_msgs::msg::AgentState state;
  mascot_msgs::msg::AgentCommand command;
  mascot_msgs::msg::AgentMessage message;
  DecodeEvents(row, decoded);
  for (std::size_t i = 0; i < decoded.motions.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    DecodeSample(row, Topic::State(id), state);
    decoded.motions[i] = FromWire(state);
    decoded.events_so_far = static_cast<int>(state.events());
    decoded.messages[i].clear();
    if (!row.messages[i].empty()) {
      DecodeSample(row, Topic::Message(id), message);
      decoded.messages[i].assign(message.data().begin(), message.data().end());
    }
    if (row.commands[i].empty()) continue;
    DecodeSample(row, Topic::Command(id), command);
    decoded.commands[i] = FromWire(command);
  }
}

const Row& RowEncoder::Encode(std::int64_t tick, const DecodedRow& decoded) {
  const int rate = experiment_.control.rate_hz;
  row_.tick = tick;
  ToWire(tick, rate, clock_);
  Serialize(clock_, row_.clock);
  row_.events.resize(decoded.events.size());
  for (std::size_t k = 0; k < decoded.events.size(); ++k) {
    ToWire(tick, rate, decoded.events[k].number, decoded.events[k].event.Toml(), event_);
    Serialize(event_, row_.events[k]);
  }
  for (std::size_t i = 0; i < decoded.motions.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    ToWire(tick, rate, id, decoded.events_so_far, decoded.motions[i], state_);
    Serialize(state_, row_.states[i]);
    ToWire(tick, rate, id, decoded.commands[i], command_);
    Serialize(command_, row_.commands[i]);
    if (!experiment_.agents[i].sends_messages) continue;
    ToWire(tick, rate, id, decoded.messages[i], message_);
    Serialize(message_, row_.messages[i]);
  }
  return row_;
}

SampleSizes SizesOfSamples() {
  return {.state = BytesOf(mascot_msgs::msg::AgentState()), .message = BytesOf(mascot_msgs::msg::AgentMessage())};
}

}  // namespace mascot
