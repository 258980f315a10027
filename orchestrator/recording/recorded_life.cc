#include "orchestrator/recording/recorded_life.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bus/sample_layout.h"
#include "experiment/processes.h"

namespace mascot {
namespace {

int EventsSoFar(const Row::Bytes& state) {
  if (state.size() != kEncapsulation.size() + kStateBody) return -1;
  return static_cast<int>(HeadOf(state.data() + kEncapsulation.size()).more);
}

}  // namespace

RecordedLife::RecordedLife(const std::string& file, const McapContents& contents, const RecordingPlan& plan,
                           const Experiment& experiment, int agent)
    : file_(file),
      plan_(plan),
      experiment_(experiment),
      agent_(agent),
      sources_(SourcesOf(experiment, {agent, agent})),
      rows_(file, plan.agents, plan.rate_hz),
      messages_(experiment.agents.size()),
      next_messages_(experiment.agents.size()) {
  if (plan.ticks_per_row > 1)
    throw ConfigError(
        {fmt::format("{}: expected a recording of every tick, which the agent answers, got one of every "
                     "{} ticks (record.rate_hz)",
                     file, plan.ticks_per_row)});
  for (const int id : sources_)
    Require(Topic::State(id), id == agent ? "which is its own" : fmt::format("which agent {} hears", agent));
  for (const int id : sources_)
    if (id != agent && experiment.agent(id).sends_messages) senders_.push_back(id);
  if (plan.realtime && !senders_.empty())
    throw ConfigError(
        {fmt::format("{}: expected run.mode = \"lockstep\" for a law that sends messages, got "
                     "\"realtime\": nobody has recorded when they reached agent {}",
                     file, agent)});
  for (const int id : senders_) Require(Topic::Message(id), fmt::format("which agent {} hears", agent));
  if (experiment.agent(agent).takes_actions) Require(Topic::Action(agent), "which says what it was to do");
  Require(Topic::Command(agent), "with which its answers are compared");
  if (!experiment.events.empty()) Require(Topic::Event(), "which changes the run");
  has_messages_ = experiment.agent(agent).sends_messages &&
                  std::ranges::find(plan.topics, Topic::Message(agent)) != plan.topics.end();
  if (TicksBegun(contents, plan) == 0) {
    const std::string loss = LossOf(contents);
    throw ConfigError({file + ": expected a recording with messages, got none" + (loss.empty() ? "" : ": " + loss)});
  }
  ReadEvents();
}

void RecordedLife::Require(const Topic& topic, const std::string& why) const {
  if (std::ranges::find(plan_.topics, topic) == plan_.topics.end())
    throw ConfigError({fmt::format("{}: holds no {}, {}: record.topics left it out", file_, topic.Name(), why)});
}

void RecordedLife::ReadEvents() {
  McapReader reader(file_);
  while (const McapContents::Message* message = reader.Next()) {
    if (reader.contents().channels.at(message->channel).topic != Topic::Event().Name()) continue;
    mascot_msgs::msg::Event& sample = events_.emplace_back();
    Deserialize(message->data, sample);
    const Event event = FromWire(sample, experiment_.size());
    silences_.Take(event);
    if (event.restart == agent_) restarts_.push_back(event.tick);
  }
}

std::vector<mascot_msgs::msg::Event> RecordedLife::EventsBefore(std::int64_t tick) const {
  std::vector<mascot_msgs::msg::Event> events;
  std::ranges::copy_if(events_, std::back_inserter(events),
                       [tick](const mascot_msgs::msg::Event& event) { return std::cmp_less(event.tick(), tick); });
  return events;
}

bool RecordedLife::Restarts(std::int64_t tick) const { return std::ranges::find(restarts_, tick) != restarts_.end(); }

std::string RecordedLife::Missing(const Tick& tick) const {
  const Row& row = *tick.row;
  for (const int id : sources_)
    if (row.states[static_cast<std::size_t>(id - 1)].empty()) return Topic::State(id).Name();
  if (!tick.answers) return plan_.realtime ? "" : Topic::Command(agent_).Name();
  if (experiment_.agent(agent_).takes_actions && row.actions[static_cast<std::size_t>(agent_ - 1)].empty())
    return Topic::Action(agent_).Name();
  for (const int id : senders_)
    if (row.tick > 0 && messages_[static_cast<std::size_t>(id - 1)].empty() && !silences_.Has(id, row.tick - 1))
      return Topic::Message(id).Name() + " of the tick before";
  return "";
}

std::optional<RecordedLife::Tick> RecordedLife::Next() {
  const Row* const row = rows_.Next();
  if (row == nullptr) return std::nullopt;
  if (row->tick != tick_ + 1) throw std::runtime_error(fmt::format("{}: tick {} is missing", file_, tick_ + 1));
  tick_ = row->tick;
  std::swap(messages_, next_messages_);
  next_messages_ = row->messages;
  Tick tick{.row = row, .messages = &messages_};
  tick.is_lost = silences_.Has(agent_, tick_);
  tick.answers = !tick.is_lost && !row->commands[static_cast<std::size_t>(agent_ - 1)].empty();
  if (!tick.is_lost) {
    if (const std::string missing = Missing(tick); !missing.empty()) {
      if (!rows_.HasMore()) return std::nullopt;  // where the recording, or the run, was cut
      throw std::runtime_error(fmt::format("{}: tick {} has no {}", file_, tick_, missing));
    }
    const int so_far = EventsSoFar(row->states[static_cast<std::size_t>(agent_ - 1)]);
    const auto known = std::ranges::count_if(
        events_, [this](const mascot_msgs::msg::Event& event) { return std::cmp_less_equal(event.tick(), tick_); });
    if (std::cmp_less(known, so_far))
      throw std::runtime_error(
          fmt::format("{}: {} events have taken effect by tick {}, of which it holds {}", file_, so_far, tick_, known));
  }
  tick.begins = !tick.is_lost && (!lives_ || Restarts(tick_));
  lives_ = !tick.is_lost;
  return tick;
}

}  // namespace mascot
