#include "orchestrator/engines/dds/player.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "base/number.h"
#include "bus/addresses.h"
#include "bus/resources.h"
#include "experiment/processes.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/dds/run_phases.h"
#include "system/descendants.h"
#include "system/failure.h"
#include "system/spawn.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

/// DomainOptions::number: this process has a high one, which programs of others do not take by themselves.
constexpr int kPlayersNumber = 117, kFirstOfAgents = 3, kLastOfAgents = 110;
constexpr auto kAskReadyEvery = 200ms;
constexpr auto kRepeatAfter = 200ms;  // and then after twice the time, and so on
constexpr int kDescriptors = 120;

}  // namespace

Player::Player(RecordedLife& life, const Experiment& experiment, int agent, Program program, Decisions& decisions,
               Console& console, StopSignal& stop)
    : life_(life),
      experiment_(experiment),
      agent_(agent),
      process_(ProcessName({agent, agent})),
      program_(std::move(program)),
      decisions_(decisions),
      console_(console),
      stop_(stop),
      number_(kFirstOfAgents - 1),
      logs_([this](const std::string& process, const std::string& line) { console_.ChildLine(process, line); },
            [this](const std::string& words) { console_.Warning(words); }),
      children_(logs_),
      audit_(experiment, peers_) {}

Player::~Player() { End(); }

Player::Result Player::Play() {
  try {
    Join();
    if (result_.signal == 0) PlayTicks();
  } catch (const std::exception& failure) {
    result_.failure = InWords(failure);
  }
  console_.EndProgress();
  return result_;
}

DomainOptions Player::Options() const {
  DomainOptions options;
  options.domain = own_domain_->domain();
  options.transport = TransportOf(experiment_);
  options.name = kOrchestrator;
  options.number = is_star_ ? kPlayersNumber : -1;
  options.loopback = true;
  if (is_star_) options.peers = {kPlayersNumber};
  options.participants = 2 + static_cast<int>(life_.sources().size()) / 4;  // of 32 KiB: a state and a message are 0.7
  options.patient = !program_.debugger.empty();
  return options;
}

void Player::Join() {
  own_domain_.emplace(experiment_.network.domain);
  is_star_ = TransportOf(experiment_) != "shm" && !IsUdpPortInUse(DiscoveryPort(own_domain_->domain(), kPlayersNumber));
  RequireAddresses(Options());
  RequireResources({.shared_memory = 2 * SharedMemoryNeeded(Options()), .processes = 2, .descriptors = kDescriptors});
  if (program_.is_plain()) {  // others may outlive us: the janitor ends them
    children_.Share(own_domain_->janitor().lifeline());
    for (const int descriptor : own_domain_->lock().descriptors()) children_.Share(descriptor);
  }
  console_.Line("DDS domain " + std::to_string(own_domain_->domain()));
  domain_.emplace(
      Options(), [this] { stop_.Wake(); }, &peers_, &audit_);
  const ProcessKey ours = ProcessKey::Of(domain_->guid_prefix());
  peers_.Know(kOrchestrator, ours);
  peers_.Know(kPhysicsServer, ours);
  for (const AgentConfig& agent : experiment_.agents)
    if (agent.id != agent_) peers_.Know(ProcessName({agent.id, agent.id}), ours);
  if (!program_.is_plain())
    peers_.Await(process_, ProcessKey());  // its process id is the business of the program around it
  links_.emplace(
      *domain_, peers_, experiment_,
      LogFile(logs_folder_.path() / "orchestrator.log", [this](const std::string& words) { console_.Warning(words); }),
      [this] { stop_.Wake(); });
  events_.emplace(*domain_, Topic::Event());
  if (experiment_.agent(agent_).takes_actions) actions_.emplace(*domain_, Topic::Action(agent_));
}

void Player::Connect() {
  delivery_.reset();
  delivery_ = MakeReplayDelivery(*domain_, experiment_, agent_, [this](const ReplayDelivery::Answer& answer) {
    {
      const std::lock_guard lock(mutex_);
      answer_ = answer;
    }
    stop_.Wake();
  });
}

void Player::PlayTicks() {
  while (const auto tick = life_.Next()) {
    tick_ = tick->row->tick;
    if (lives_ && (tick->is_lost || tick->begins)) Lose(tick_);
    result_.lost += tick->is_lost;
    if (tick->begins) Begin(tick_);
    if (!lives_) {
      if (result_.signal != 0) return;
      continue;
    }
    PlayEvents(*tick->row);
    if (tick->answers)
      PlayTick(*tick);
    else
      ++result_.missed;
    if (result_.signal != 0) return;
    console_.Progress(
        static_cast<double>(tick_ + 1) / static_cast<double>(experiment_.ticks() + 1),
        fmt::format(
            "{} at {} s, {}", process_, ShortestFloat(experiment_.time_s(tick_)),
            decisions_.differing() == 0 ? "the same so far" : fmt::format("{} ticks differ", decisions_.differing())));
  }
}

void Player::Begin(std::int64_t tick) {
  lives_ = true;
  hears_ = false;
  ++result_.processes;
  number_ = number_ == kLastOfAgents ? kFirstOfAgents : number_ + 1;
  {
    const std::lock_guard lock(mutex_);
    answer_.reset();
  }
  Connect();
  Spawn(tick);
  if (tick > 0) {
    links_->HandOutExperiment(tick, life_.EventsBefore(tick));
    console_.Line(fmt::format("{} starts afresh at {} s", process_, ShortestFloat(experiment_.time_s(tick))));
  }
  AwaitReady(tick);
}

/// The agent was lost in the run: its process ends here, if it has not ended by itself because of the event.
void Player::Lose(std::int64_t tick) {
  lives_ = false;
  children_.Kill(process_);
  if (debugger_.number() != 0) {
    console_.Line(
        fmt::format("{} was lost at {} s: its process ends here", process_, ShortestFloat(experiment_.time_s(tick))));
    links_->Ask(Ask::kEnd, "lost");
    AwaitDebugger();
  }
  audit_.OnEnd(process_);
  peers_.Vacate(process_);
}

/// Waits until the debugger has ended, or a signal comes that is not for it.
void Player::AwaitDebugger() {
  while (debugger_.number() != 0 && !debugger_.ReapIfEnded())
    if (const int signal = stop_.Within(200ms); signal != 0 && signal != SIGINT) {
      result_.signal = signal;
      return;
    }
}

std::vector<std::string> Player::ArgumentsOf(std::int64_t tick) const {
  const DomainOptions options = Options();
  std::vector<std::string> arguments = mascot::ArgumentsOf(experiment_, options.domain, AgentRange{agent_, agent_});
  arguments.insert(arguments.end(),
                   {"--loopback", program_.is_plain() ? "--parent" : "--orchestrator", std::to_string(getpid())});
  if (is_star_)
    arguments.insert(arguments.end(), {"--participant", std::to_string(number_), "--peers",
                                       std::to_string(kPlayersNumber), "--awaits", "1"});
  if (options.patient) arguments.push_back("--patient");
  if (tick > 0) arguments.insert(arguments.end(), {"--from-tick", std::to_string(tick)});
  return arguments;
}

void Player::Spawn(std::int64_t tick) {
  std::vector<std::string> arguments = ArgumentsOf(tick);
  std::vector<std::string> words = program_.debugger;
  if (program_.command.empty()) {
    words.push_back(ProgramFolder() / "agent");
  } else {
    words.insert(words.end(), {"/bin/sh", "-c", "exec " + program_.command + " \"$@\"", "sh"});
  }
  words.insert(words.end(), arguments.begin(), arguments.end());
  if (!program_.debugger.empty()) {
    debugger_ = mascot::Spawn({.words = words, .signals = mascot::Program::Signals::kDefault});
    return;
  }
  arguments.assign(std::next(words.begin()), words.end());
  const pid_t pid = children_.Spawn(process_, words.front(), arguments,
                                    logs_folder_.path() / fmt::format("{}_{}.log", process_, tick));
  if (program_.is_plain()) peers_.Know(process_, ProcessKey::WithPid(pid));
}

bool Player::IsReady(std::int64_t tick) const {
  const auto status = links_->StatusOf(process_);
  return status && std::cmp_equal(status->from_tick(), tick) && static_cast<Life>(status->state()) == Life::kReady &&
         events_->HasReaderOf(process_) && (!actions_ || actions_->HasReaderOf(process_)) && delivery_->Matched();
}

void Player::AwaitReady(std::int64_t tick) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(experiment_.run.start_timeout_s);
  auto ask_again = Clock::now() + kAskReadyEvery;
  while (!IsReady(tick)) {
    if (!Wait(50ms)) return;
    links_->HandOutExperiment();
    if (Clock::now() > ask_again) {  // what it said before we knew it is lost
      links_->Ask(Ask::kReport, "to begin");
      ask_again = Clock::now() + kAskReadyEvery;
    }
    if (program_.debugger.empty() && Clock::now() > deadline)
      throw std::runtime_error(fmt::format("{} was not ready within run.start_timeout_s = {} s", process_,
                                           ShortestFloat(experiment_.run.start_timeout_s)));
  }
}

void Player::PlayEvents(const Row& row) {
  for (Row::Bytes event : row.events) events_->Write(event);
}

void Player::PlayTick(const RecordedLife::Tick& tick) {
  hears_ = true;
  const auto at = static_cast<std::size_t>(agent_ - 1);
  if (actions_) {
    Row::Bytes action = tick.row->actions[at];
    actions_->Write(action);
  }
  delivery_->Publish(*tick.row, *tick.messages);
  Await(tick_);
  if (result_.signal != 0) return;
  ReplayDelivery::Answer answer;
  {
    const std::lock_guard lock(mutex_);
    answer = *answer_;
  }
  if (life_.has_messages()) decisions_.AddMessage(tick_, tick.row->messages[at], answer.message);
  decisions_.AddCommand(tick_, tick.row->commands[at], answer.command);
  if (said_first_ || !decisions_.first()) return;
  said_first_ = true;
  if (!program_.debugger.empty()) console_.Line(fmt::format("{}: differs from here on", At()));
}

/// Waits until the agent has answered this tick, or a signal comes.
void Player::Await(std::int64_t tick) {
  const auto begin = Clock::now();
  const std::chrono::duration<double> limit(experiment_.run.agent_timeout_s);
  Clock::duration repeat_after = kRepeatAfter;
  auto repeat_at = begin + repeat_after;
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (answer_ && answer_->tick == tick) return;
      if (answer_ && answer_->tick > tick)
        throw std::runtime_error(
            fmt::format("{}: {} has answered tick {}, which it has not heard yet", At(), process_, answer_->tick));
    }
    const auto now = Clock::now();
    if (program_.debugger.empty() && now - begin > limit)
      throw std::runtime_error(fmt::format("{}: no answer of {} within run.agent_timeout_s = {} s", At(), process_,
                                           ShortestFloat(experiment_.run.agent_timeout_s)));
    if (now > repeat_at) {
      delivery_->AskAgain();
      repeat_after *= 2;
      repeat_at = now + repeat_after;
    }
    if (!Wait(50ms)) return;
  }
}

bool Player::Wait(std::chrono::nanoseconds timeout) {
  const int signal = stop_.Within(timeout);
  const bool is_the_debuggers = !program_.debugger.empty() && signal == SIGINT;  // it has our terminal
  if (signal != 0 && !is_the_debuggers) {
    result_.signal = signal;
    return false;
  }
  domain_->RethrowFailure();
  LookAtProcess();
  if (const std::string violation = audit_.Violation(); !violation.empty()) throw std::runtime_error(violation);
  return true;
}

void Player::LookAtProcess() {
  if (debugger_.number() != 0) {
    if (const auto end = debugger_.ReapIfEnded())
      throw std::runtime_error(fmt::format("{}: the debugger of {} {}", At(), process_, EndText(*end)));
    return;
  }
  for (const Exit& exit : children_.Reap())
    throw std::runtime_error(At() + ": " + StoryOfEnd(exit.process, exit.Text(), logs_.LastLines(exit.process)));
}

/// "tick 57 (0.57 s)"; "before the first tick"; of a fresh process "before tick 57 (0.57 s)".
std::string Player::At() const {
  if (!hears_ && tick_ <= 0) return "before the first tick";
  return (hears_ ? "" : "before ") + fmt::format("tick {} ({} s)", tick_, ShortestFloat(experiment_.time_s(tick_)));
}

bool Player::End() {
  if (std::exchange(ended_, true)) return let_go_;
  const bool in_order = result_.failure.empty() && result_.signal == 0;
  if (links_ && (!children_.empty() || debugger_.number() != 0)) {
    try {
      links_->Ask(Ask::kEnd, in_order ? "done" : "over");
    } catch (const std::exception& failure) {
      console_.Line(InWords(failure));
    }
    if (in_order && debugger_.number() != 0)
      console_.Line("all of the recording is played: the comparison comes when the debugger ends");
    if (in_order) AwaitDebugger();
    constexpr auto kGrace = 5s;
    if (in_order) children_.WaitAll(kGrace);
  }
  children_.Stop(2s);
  debugger_ = ChildProcess();
  KillDescendants({own_domain_ ? own_domain_->janitor().process() : 0});
  if (!own_domain_) return true;
  const bool is_half_made = !domain_;  // a participant that failed to join has files open until our end
  try {
    let_go_ = own_domain_->Leave(
        [this] {
          delivery_.reset();
          actions_.reset();
          events_.reset();
          links_.reset();
          domain_.reset();
        },
        stop_);
  } catch (const std::exception& failure) {
    console_.Line(InWords(failure));
  }
  return let_go_ || is_half_made;
}

}  // namespace mascot
