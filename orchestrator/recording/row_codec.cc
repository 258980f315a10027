#include "orchestrator/recording/row_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "bus/sample_layout.h"

namespace mascot {
namespace {

/// `AnyRow` is Row or const Row.
template <class AnyRow>
auto& SampleIn(AnyRow& row, const Topic& topic) {
  const auto agent = static_cast<std::size_t>(topic.agent - 1);
  return topic.kind == TopicKind::kState     ? row.states[agent]
         : topic.kind == TopicKind::kCommand ? row.commands[agent]
         : topic.kind == TopicKind::kMessage ? row.messages[agent]
         : topic.kind == TopicKind::kAction  ? row.actions[agent]
                                             : row.clock;
}

/// The body of a sample of `row`. Throws std::runtime_error with tick and topic if it has not this size.
const std::uint8_t* BodyOf(const Row& row, const Topic& topic, std::size_t body) {
  const Row::Bytes& bytes = SampleIn(row, topic);
  if (bytes.size() != kEncapsulation.size() + body || !std::ranges::equal(kEncapsulation, std::span(bytes).first<4>()))
    throw std::runtime_error(fmt::format("tick {}: {}: a sample of {} bytes is no {}", row.tick, topic.Name(),
                                         bytes.size(), WireTypeName(topic.kind)));
  return bytes.data() + kEncapsulation.size();
}

/// The body of a message or an action of `row`, which has at most `most` numbers. Throws as BodyOf() does.
const std::uint8_t* BodyOfNumbers(const Row& row, const Topic& topic, std::size_t most) {
  const Row::Bytes& bytes = SampleIn(row, topic);
  const bool has_head = bytes.size() >= kEncapsulation.size() + MessageBody(0);
  const std::size_t numbers = has_head ? HeadOf(bytes.data() + kEncapsulation.size()).more : 0;
  return BodyOf(row, topic, MessageBody(std::min(numbers, most + 1)));
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
  DecodeEvents(row, decoded);
  decoded.events_so_far = DecodeStates(row, decoded.motions);
  for (std::size_t i = 0; i < decoded.motions.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    decoded.messages[i].clear();
    if (!row.messages[i].empty()) GetMessage(BodyOfNumbers(row, Topic::Message(id), kMaxNumbers), decoded.messages[i]);
    DecodeAction(row, id, decoded.actions[i]);
    decoded.has_answered[i] = !row.commands[i].empty();
    if (decoded.has_answered[i] != 0) GetCommand(BodyOf(row, Topic::Command(id), kCommandBody), decoded.commands[i]);
  }
}

int DecodeStates(const Row& row, std::span<Motion> motions) {
  std::uint32_t events = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::uint8_t* const state = BodyOf(row, Topic::State(static_cast<int>(i) + 1), kStateBody);
    GetState(state, motions[i]);
    events = HeadOf(state).more;
  }
  return static_cast<int>(events);
}

void DecodeAction(const Row& row, int id, std::vector<double>& action) {
  action.clear();
  if (row.actions[static_cast<std::size_t>(id - 1)].empty()) return;
  GetMessage(BodyOfNumbers(row, Topic::Action(id), kMaxActionNumbers), action);
}

const Row& RowEncoder::Encode(std::int64_t tick, const DecodedRow& decoded) {
  const int rate = experiment_.control.rate_hz;
  row_.tick = tick;
  PutClock(tick, rate, BodyIn(row_.clock, kClockBody));
  row_.events.resize(decoded.events.size());
  for (std::size_t k = 0; k < decoded.events.size(); ++k) {
    mascot_msgs::msg::Event event;
    ToWire(tick, rate, decoded.events[k].number, decoded.events[k].event.Toml(), event);
    Serialize(event, row_.events[k]);
  }
  for (std::size_t i = 0; i < decoded.motions.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    PutState(tick, rate, id, decoded.events_so_far, decoded.motions[i], BodyIn(row_.states[i], kStateBody));
    row_.commands[i].clear();
    row_.messages[i].clear();
    row_.actions[i].clear();
    if (decoded.has_answered[i] == 0) continue;
    if (experiment_.agents[i].takes_actions) {
      const std::vector<double>& action = decoded.actions[i];
      PutMessage(tick, rate, id, action, BodyIn(row_.actions[i], MessageBody(action.size())));
    }
    PutCommand(tick, rate, id, decoded.commands[i], BodyIn(row_.commands[i], kCommandBody));
    if (!experiment_.agents[i].sends_messages) continue;
    const std::vector<double>& message = decoded.messages[i];
    PutMessage(tick, rate, id, message, BodyIn(row_.messages[i], MessageBody(message.size())));
  }
  return row_;
}

SampleSizes SizesOfSamples() {
  return {.state = kEncapsulation.size() + kStateBody, .message = kEncapsulation.size() + MessageBody(0)};
}

}  // namespace mascot
