// Fuzzer: any order of any events, at the plain objects that take samples from the wire. Their answers must keep the
// promises of their headers. The first byte chooses the object, the rest is its events.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "agent/process/tick_inbox.h"
#include "bus/wire.h"
#include "experiment/silences.h"
#include "orchestrator/engines/dds/process_table.h"
#include "orchestrator/engines/dds/row_window.h"
#include "orchestrator/engines/dds/run_phases.h"
#include "orchestrator/recording/row_assembler.h"
#include "physics_server/process/join_list.h"
#include "physics_server/process/tick_protocol.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

using Events = FuzzedDataProvider;
using Time = std::chrono::steady_clock::time_point;

constexpr std::int64_t kLastTick = 1'000'000'000;  // of any experiment

/// Mostly a tick near `around`, sometimes any number.
std::int64_t SomeTick(Events& events, std::int64_t around) {
  const std::int64_t next = std::clamp<std::int64_t>(around, -1, kLastTick);
  return events.ConsumeBool() ? next + events.ConsumeIntegralInRange<std::int64_t>(-3, 3)
                              : events.ConsumeIntegral<std::int64_t>();
}

/// As SomeTick(), but a tick that a run can have: what other processes send is checked before it becomes a View.
std::int64_t TickOfRun(Events& events, std::int64_t around) {
  return std::clamp<std::int64_t>(SomeTick(events, around), -1, kLastTick);
}

/// A time that does not go back.
void Pass(Events& events, Time& now) { now += std::chrono::milliseconds(events.ConsumeIntegralInRange<int>(0, 3000)); }

void FuzzTickInbox(Events& events) {
  const bool realtime = events.ConsumeBool();
  const std::vector<TickInbox::Peer> peers = {{2, events.ConsumeBool()}, {3, events.ConsumeBool()}};
  TickInbox inbox(1, peers, realtime);
  std::int64_t answered = -1;
  const auto judge = [&](const std::optional<TickInbox::CompleteTick>& complete) {
    if (!complete) return;
    Require(complete->tick > answered && complete->self != nullptr && complete->samples.size() == peers.size(),
            "a tick was complete twice, or incompletely");
    answered = complete->tick;
    for (const Sample& sample : complete->samples) {
      Require(sample.motion != nullptr, "a sample without a motion");
      Require(std::ranges::all_of(sample.message, [](double number) { return number == 7; }), "a message of nobody");
    }
  };
  const std::vector<double> data(events.ConsumeIntegralInRange<std::size_t>(0, 64), 7.0);
  while (events.remaining_bytes() > 0) {
    const auto source = events.ConsumeIntegralInRange<std::size_t>(0, 2);
    const std::int64_t tick = SomeTick(events, answered);
    if (events.ConsumeBool()) {
      judge(inbox.OnState(source, tick, Motion()));
    } else if (source > 0) {
      judge(inbox.OnMessage(source, tick, data));
    }
  }
}

void FuzzTickProtocol(Events& events) {
  TickProtocol::Rules rules{.agents = 3, .last_tick = events.ConsumeIntegralInRange<std::int64_t>(0, 20)};
  if (events.ConsumeBool()) rules.period_s = 0.01;
  rules.agent_timeout_s = 5;
  rules.recorder_window = 4;
  TickProtocol protocol(rules);
  Time now{};
  std::int64_t tick = 0, published = -1, recorded = 0;
  std::array<bool, 3> lost{};
  bool held = false;
  const auto carry_out = [&](const TickProtocol::Actions& actions) {
    Require(!actions.publish || !held, "published while it was held");
    if (actions.step) Require(++tick <= rules.last_tick, "stepped beyond the last tick");
    if (actions.publish) {
      Require(published == tick - 1, "published a tick twice, or left one out");
      published = tick;
    }
    Require(protocol.published() == published, "published what it did not ask for");
    Require(published < recorded + rules.recorder_window, "published what the recorder has no room for");
    Require(protocol.last_whole() == published || protocol.last_whole() == published - 1,
            "more is unknown than a tick");
  };
  while (events.remaining_bytes() > 0) {
    const bool stop = events.ConsumeProbability<double>() < 0.02;
    const int id = events.ConsumeIntegralInRange<int>(1, 3);
    bool& is_lost = lost[static_cast<std::size_t>(id - 1)];
    switch (events.ConsumeIntegralInRange<int>(0, 6)) {
      case 0:
        if (published < 0) carry_out(protocol.Start());
        break;
      case 4:
        is_lost = true;
        carry_out(protocol.Lose(id, events.ConsumeBool()));
        break;
      case 5:
        if (is_lost) protocol.Regain(id);
        is_lost = false;
        break;
      case 6:
        if (held) {
          held = false;
          carry_out(protocol.Release());
        } else if (published >= 0) {
          held = true;
          protocol.Hold();
        }
        break;
      case 1:
        recorded = events.ConsumeBool() ? published + 1 : recorded;
        carry_out(protocol.OnRecorded(recorded));
        break;
      case 2: {
        const TickProtocol::Actions actions = protocol.OnCommand(id, SomeTick(events, published), stop);
        Require(!actions.take || !is_lost, "took a command of an agent that is lost");
        carry_out(actions);
        break;
      }
      default: {
        Pass(events, now);
        const TickProtocol::Turn turn = protocol.Look(now, stop);
        for (const int late : turn.late) Require(!lost[static_cast<std::size_t>(late - 1)], "waits for who is lost");
        if (!turn.failure.empty()) return;
        carry_out(turn.actions);
      }
    }
  }
}

void FuzzJoinList(Events& events) {
  JoinList list(events.ConsumeIntegralInRange<int>(1, 5), 10);
  Time now{};
  list.Begin(now);
  while (events.remaining_bytes() > 0) {
    list.OnAgents({events.ConsumeIntegral<int>(), events.ConsumeIntegral<int>()}, events.ConsumeBool());
    list.OnRecorder(events.ConsumeBool());
    Pass(events, now);
    if (list.Look(now, events.ConsumeBool()) == JoinList::Next::kFail)
      Require(!list.Failure().empty(), "failed without a reason");
  }
}

void FuzzRowWindow(Events& events) {
  std::vector<Topic> topics = {Topic::Command(1), Topic::State(1), Topic::Message(2), Topic::State(2), Topic::Clock()};
  const std::size_t received = topics.size();
  const bool realtime = events.ConsumeBool(), takes_actions = events.ConsumeBool();
  if (takes_actions) topics.push_back(Topic::Action(1));
  RowWindow window({.topics = topics,
                    .agents = 2,
                    .last_tick = 50,
                    .realtime = realtime,
                    .ticks = 8,
                    .patience = 4,
                    .batch = 2,
                    .doubts = events.ConsumeBool()});
  std::vector<std::int64_t> sequences(topics.size(), 0);
  std::int64_t event_tick = 0, event_sequence = 0, acted = -1;
  Silences silences;
  Row row(2);
  const auto lose_or_regain = [&] {
    const int agent = events.ConsumeIntegralInRange<int>(1, 2);
    if (events.ConsumeBool()) return window.Settle();
    event_tick = std::max(event_tick, SomeTick(events, window.rows()));
    Event event{.tick = event_tick};
    if (events.ConsumeBool())
      event.restart = agent;
    else
      event.fault = Fault{.agent = agent, .kind = FaultKind::kKill, .unanswered = events.ConsumeBool()};
    window.TakeEvent(event, std::vector<std::uint8_t>(3), ++event_sequence);
    silences.Take(event);
    Require(window.IsLost(agent) == silences.Has(agent, 50), "does not know who is lost");
  };
  const auto act = [&] {
    if (!takes_actions || !window.HasStates(acted + 1)) return;
    ++acted;
    if (!window.IsSilent(topics.back(), acted)) window.Take(topics.size() - 1, acted, std::vector<std::uint8_t>(3));
    window.EndActions(acted);
  };
  const auto judge = [&] {
    Require(!takes_actions || row.tick <= acted, "a row before its actions");
    Require(!takes_actions || !realtime || row.actions[0].empty() || !row.commands[0].empty(),
            "an action that nobody has taken");
    for (const Topic& topic : topics) {
      if (topic.kind != TopicKind::kCommand && topic.kind != TopicKind::kMessage) continue;
      const bool is_silent = silences.Has(topic.agent, row.tick);
      const auto& samples = topic.kind == TopicKind::kCommand ? row.commands : row.messages;
      const bool is_there = !samples[static_cast<std::size_t>(topic.agent - 1)].empty();
      Require(!is_silent || !is_there, "an answer of an agent that is lost");
      Require(is_silent || is_there || realtime, "a row without an answer");
    }
  };
  try {
    while (events.remaining_bytes() > 0) {
      if (events.ConsumeProbability<double>() < 0.2) {
        lose_or_regain();
        continue;
      }
      act();
      const auto index = events.ConsumeIntegralInRange<std::size_t>(0, received - 1);
      const bool is_good = events.ConsumeProbability<double>() < 0.98;
      const std::int64_t tick = is_good ? window.rows() + events.ConsumeIntegralInRange<std::int64_t>(0, 3)
                                        : std::clamp<std::int64_t>(SomeTick(events, window.rows()), 0, kLastTick);
      window.CheckSequence(index,
                           is_good ? ++sequences[index] : events.ConsumeIntegralInRange<std::int64_t>(1, INT64_MAX));
      window.Take(index, tick, std::vector<std::uint8_t>(3),
                  event_sequence + events.ConsumeIntegralInRange<std::int64_t>(-1, 1));
      const std::int64_t rows = window.rows();
      if (!window.Next(events.ConsumeBool(), row)) continue;
      Require(row.tick == rows && window.rows() == rows + 1, "a row twice");
      judge();
    }
  } catch (const std::runtime_error&) {  // a sample is missing, or too far ahead
  }
}

void FuzzRowAssembler(Events& events) {
  constexpr int kRate = 100;
  const std::int64_t ticks = events.ConsumeIntegralInRange<std::int64_t>(1, 10);
  const RecordedTicks recorded(ticks, 1 + ticks % 3);
  std::int64_t rows = 0;
  const std::vector<int> commands = events.ConsumeBool() ? std::vector{1, 2} : std::vector<int>{};
  RowAssembler assembler({"fuzz.mcap", 2, kRate, recorded, commands}, [&](const Row& row) {
    Require(row.tick == recorded.TickOf(rows++), "a row twice, or left out");
  });
  const Topic topics[] = {Topic::Command(1), Topic::State(1), Topic::Command(2), Topic::State(2)};
  for (std::size_t k = 0; k < std::size(topics); ++k) assembler.AddChannel(static_cast<std::uint16_t>(k), topics[k]);
  McapContents::Message message;
  message.data.resize(3);
  try {
    while (events.remaining_bytes() > 0) {
      message.channel = events.ConsumeIntegralInRange<std::uint16_t>(0, std::size(topics));
      message.log_time = events.ConsumeBool()
                             ? StampNs(recorded.TickOf(rows + events.ConsumeIntegralInRange<int>(0, 1)), kRate)
                             : events.ConsumeIntegral<std::uint64_t>();
      assembler.Take(message);
    }
    assembler.Finish();
    Require(rows == recorded.rows(), "ended with rows missing");
  } catch (const std::runtime_error&) {  // a tick is missing
  }
}

void FuzzProcessTable(Events& events) {
  const std::vector<std::string> processes = {"physics_server", "agent_1", "agent_2"};
  ProcessTable table({.processes = processes, .external = {false, true}, .last_tick = 50});
  Time now{};
  while (events.remaining_bytes() > 0) {
    const std::string& process = processes[events.ConsumeIntegralInRange<std::size_t>(0, processes.size() - 1)];
    ProcessTable::Status status;
    status.process(events.ConsumeRandomLengthString(80).c_str());
    status.agent(events.ConsumeIntegral<std::uint32_t>());
    status.state(events.ConsumeBool() ? events.ConsumeIntegralInRange<std::uint8_t>(0, 6)
                                      : events.ConsumeIntegral<std::uint8_t>());
    status.tick(static_cast<std::uint64_t>(SomeTick(events, 50)));
    status.reason(events.ConsumeRandomLengthString(20).c_str());
    try {
      table.OnStatus(process, status);
      Require(table.Of(process).has_value(), "a status was forgotten");
    } catch (const std::runtime_error&) {  // an external agent failed, or the status is none of this run
    }
    Pass(events, now);
    table.IsTimeToHandOut(now);
    table.IsTimeForHello(now);
    table.Missing();
  }
}

void FuzzRunPhases(Events& events) {
  const bool loses = events.ConsumeBool();  // the run goes on without an agent
  RunPhases phases({.start_timeout_s = 10,
                    .agent_timeout_s = 5,
                    .period_s = events.ConsumeBool() ? 0.01 : 0,
                    .violation = [] { return std::string(); },
                    .missing = [] { return std::string("agent_1"); },
                    .lacking = [] { return std::string("/clock of tick 2"); },
                    .is_loss = [&](const std::string&) { return loses; },
                    .last_lines = [](const std::string&) { return std::vector<std::string>{"its last words"}; }},
                   Time{});
  Time now{};
  RunPhases::Phase phase = phases.phase();
  RunPhases::View view;
  while (events.remaining_bytes() > 0) {
    Pass(events, now);
    view.rows += events.ConsumeIntegralInRange<int>(0, 3);
    view.newest_tick = TickOfRun(events, view.rows);
    view.everybody_found = events.ConsumeBool();
    view.reported = events.ConsumeBool();
    view.gave_up = phases.gives_up(now);
    if (events.ConsumeBool()) view.last_tick = TickOfRun(events, view.rows - 1);
    switch (events.ConsumeIntegralInRange<int>(0, 5)) {
      case 0:
        phases.OnSignal(events.ConsumeBool() ? 2 : 15, now);
        break;
      case 1:
        phases.OnExits(
            {{"agent_1", events.ConsumeBool() ? std::optional(events.ConsumeIntegral<int>()) : std::nullopt, "exited"}},
            now);
        break;
      case 2:
        phases.Fail("because");
        break;
      case 3:
        if (phases.phase() == RunPhases::Phase::kCollecting) phases.Collected(view, now);
        break;
      default:
        phases.Look(view, now);
    }
    Require(phases.phase() >= phase, "a phase came back");
    Require(phases.TakeLosses().empty() || loses, "an agent is lost, and the run cannot go on without it");
    phase = phases.phase();
  }
}

constexpr void (*kFuzz[])(Events& events) = {FuzzTickInbox,    FuzzTickProtocol, FuzzJoinList, FuzzRowWindow,
                                             FuzzRowAssembler, FuzzProcessTable, FuzzRunPhases};

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  mascot::Events events(data + 1, size - 1);
  mascot::kFuzz[data[0] % std::size(mascot::kFuzz)](events);
  return 0;
}
