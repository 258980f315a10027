#include "physics_server/server.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "experiment/processes.h"
#include "physics_server/agents_text.h"
#include "physics_server/timetable.h"

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

namespace {

std::chrono::nanoseconds Seconds(double s) { return std::chrono::nanoseconds(static_cast<std::int64_t>(s * 1e9)); }

std::string Shortest(double s) { return ShortestFloat(s) + " s"; }

}  // namespace

Server::Server(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      last_tick_(experiment.ticks()),
      realtime_(experiment.run.mode == Mode::kRealtime),
      roll_(experiment.size(), experiment.run.start_timeout_s),
      world_(experiment),
      watch_(ProgressWatch::Seconds(experiment.run.agent_timeout_s)),
      barrier_(experiment.size()),
      commands_(static_cast<std::size_t>(experiment.size())),
      command_tick_(static_cast<std::size_t>(experiment.size()), -1),
      clock_(domain, Topic::Clock()),
      requests_(domain, Topic::Request()),
      status_reader_(domain, Topic::Status(), [this](const mascot_msgs::msg::Status& status) { OnStatus(status); }) {
  const bool bundled = experiment.network.delivery == Delivery::kBundled;
  const int recorder = 1;
  for (const int processes : HearingProcesses(experiment, /*heard_only=*/false))
    state_readers_.push_back(recorder + (bundled ? 0 : processes));
  samples_.resize(static_cast<std::size_t>(experiment.size()));
  for (int id = 1; id <= experiment.size(); ++id) {
    states_.push_back(std::make_unique<Writer<StateType>>(domain, Topic::State(id)));
    if (bundled) bundles_.push_back(std::make_unique<Writer<BundleType>>(domain, Topic::Bundle(id)));
    command_readers_.push_back(std::make_unique<Reader<CommandType>>(
        domain, Topic::Command(id),
        [this, id](const mascot_msgs::msg::AgentCommand& command) { OnCommand(id, command); }));
  }
}

void Server::Run() {
  AwaitEveryone();
  try {
    realtime_ ? RunRealtime() : RunLockstep();
  } catch (const Ended& ended) {
    Report();
    if (ended.signal() == 0) lifecycle_.Part(Life::kEnded);  // after a signal nobody may be there to listen
    throw;
  } catch (...) {
    Report();
    throw;
  }
  Report();
}

void Server::Report() {
  const std::lock_guard lock(mutex_);
  lifecycle_.Report(static_cast<std::uint64_t>(std::max<std::int64_t>(published_, 0)),
                    pace_.Result(experiment_.period_s()), world_.contacts());
}

// --- start ----------------------------------------------------------------------------------------------

void Server::AwaitEveryone() {
  BeginRollCall();
  lifecycle_.Set(Life::kMatching);
  for (;;) {
    lifecycle_.Wait(50ms);
    const StartRoll::Next next = LookAtRoll();
    if (next == StartRoll::Next::kStart) return;
    if (next == StartRoll::Next::kAsk) AskForReports();
  }
}

void Server::BeginRollCall() {
  const std::lock_guard lock(mutex_);
  roll_.Begin(WallClock::now());
}

StartRoll::Next Server::LookAtRoll() {
  const bool matched = Matched();  // asked before the lock: it takes those of the readers
  const std::lock_guard lock(mutex_);
  const StartRoll::Next next = roll_.Look(WallClock::now(), matched);
  if (next == StartRoll::Next::kFail) throw std::runtime_error(roll_.Failure());
  return next;
}

void Server::AskForReports() {
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(Ask::kReport));
  requests_.Write(request);
}

bool Server::Matched() const {
  if (clock_.matched() < 1) return false;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i]->matched() < state_readers_[i] || command_readers_[i]->matched() < 1) return false;
  return std::ranges::all_of(bundles_, [](const auto& bundle) { return bundle->matched() >= 1; });
}

void Server::OnStatus(const mascot_msgs::msg::Status& status) {
  const std::lock_guard lock(mutex_);
  const auto life = static_cast<Life>(status.state());
  const bool ready = life == Life::kReady || life == Life::kRunning;
  if (status.process() == "recorder") {
    roll_.OnRecorder(ready);
    recorded_rows_ = static_cast<std::int64_t>(status.tick());
    if (running_) PublishIfRecorded();
    if (realtime_) lifecycle_.Wake();  // who may wait for this very row
  } else if (const auto agents = AgentsOf(status.process().to_string())) {
    roll_.OnAgents(*agents, ready);
  }
}

// --- ticks ----------------------------------------------------------------------------------------------

void Server::PublishIfRecorded() {
  const std::int64_t tick = world_.tick();
  if (published_ < tick && recorded_rows_ > tick - kRecorderWindow) Publish();
}

void Server::Publish() {
  const std::int64_t tick = world_.tick();
  const int rate = experiment_.control.rate_hz;
  published_ = tick;
  barrier_.Open(tick);
  rosgraph_msgs::msg::Clock clock;
  ToWire(tick, rate, clock);
  clock_.Write(clock);
  for (int id = 1; id <= experiment_.size(); ++id) {
    const auto i = static_cast<std::size_t>(id - 1);
    ToWire(tick, rate, id, world_.State(id), samples_[i]);
    states_[i]->Write(samples_[i]);
  }
  PublishBundles();
}

void Server::PublishBundles() {
  auto& states = bundle_.states();
  for (std::size_t i = 0; i < bundles_.size(); ++i) {
    states.clear();
    states.push_back(samples_[i]);
    for (const Graph::Neighbour& heard : experiment_.graph.HeardBy(static_cast<int>(i) + 1))
      states.push_back(samples_[static_cast<std::size_t>(heard.id - 1)]);
    bundles_[i]->Write(bundle_);
  }
}

void Server::OnCommand(int id, const mascot_msgs::msg::AgentCommand& command) {
  const std::lock_guard lock(mutex_);
  const auto i = static_cast<std::size_t>(id - 1);
  const auto tick = static_cast<std::int64_t>(command.tick());
  if (!running_ || done_ || tick > published_ || tick <= command_tick_[i]) return;
  commands_[i] = command.actuator();
  command_tick_[i] = tick;
  if (!barrier_.Answer(id, tick)) return;
  if (!realtime_)
    Advance();
  else if (tick == 0 || tick == last_tick_)
    Finish();  // in between the clock leads
}

void Server::Advance() {
  if (world_.tick() == last_tick_ || lifecycle_.stop_requested()) return Finish();
  world_.Step(commands_);
  PublishIfRecorded();
}

void Server::Finish() {
  done_ = true;
  lifecycle_.Wake();
}

void Server::Start() {
  const std::lock_guard lock(mutex_);
  running_ = true;
  lifecycle_.Set(Life::kRunning);
  PublishIfRecorded();
}

void Server::RunLockstep() {
  Start();
  WatchProgress();
}

void Server::WatchProgress() {
  while (!done_) {
    lifecycle_.Wait(50ms);
    const std::lock_guard lock(mutex_);
    // Ticks reached and ticks published: agents have their time from the latter on.
    const std::int64_t progress = world_.tick() + published_;
    if (watch_.IsOverdue(progress, WallClock::now(), AwaitsRecorder() ? RecorderGrace() : 0s) && !done_)
      throw Overdue(world_.tick());
  }
}

/// The next tick's states wait for the recorder's window. Called under the lock.
bool Server::AwaitsRecorder() const { return published_ < world_.tick(); }

/// What it measures beside the run asks the laws of all agents, one after the other, for each row.
std::chrono::nanoseconds Server::RecorderGrace() const {
  return (experiment_.size() - 1) * Seconds(experiment_.run.agent_timeout_s);
}

void Server::RunRealtime() {
  Start();
  WatchProgress();  // tick 0 is waited for, so that every agent has a command that can be held
  done_ = false;
  const double period_s = experiment_.period_s() / experiment_.run.speed;
  Timetable timetable(period_s, WallClock::now());
  for (std::int64_t tick = 0; tick < last_tick_ && !lifecycle_.stop_requested(); ++tick) {
    AwaitRecorder(tick);
    const auto due = timetable.Due(tick + 1);
    while (WallClock::now() < due) lifecycle_.Wait(due - WallClock::now());
    timetable.Come(tick + 1, WallClock::now());
    const std::lock_guard lock(mutex_);
    for (const std::int64_t answered : command_tick_) pace_.AddCommand(published_ - answered);
    CheckForDeadAgents(period_s);
    world_.Step(commands_);
    PublishIfRecorded();
    pace_.AddTick(std::chrono::duration<double>(WallClock::now() - due).count());
  }
  if (!lifecycle_.stop_requested()) WatchProgress();
}

void Server::AwaitRecorder(std::int64_t tick) {
  const auto deadline = WallClock::now() + Seconds(experiment_.run.agent_timeout_s) + RecorderGrace();
  while (!Published(tick) && !lifecycle_.stop_requested()) {
    lifecycle_.Wait(50ms);
    if (WallClock::now() < deadline) continue;
    const std::lock_guard lock(mutex_);  // Overdue reads what callbacks write
    throw Overdue(tick);
  }
}

void Server::CheckForDeadAgents(double period_s) const {
  for (const std::int64_t answered : command_tick_)
    if (static_cast<double>(published_ - answered) * period_s > experiment_.run.agent_timeout_s)
      throw Overdue(published_);
}

std::runtime_error Server::Overdue(std::int64_t tick) const {
  const std::string limit = "run.agent_timeout_s = " + Shortest(experiment_.run.agent_timeout_s);
  const std::string late = AwaitsRecorder()
                               ? "the recorder has confirmed only " + std::to_string(recorded_rows_) +
                                     " ticks, nothing within " + std::to_string(experiment_.size()) + " times "
                               : "no command from " + AgentsText(barrier_.Late()) + " within ";
  return std::runtime_error("tick " + std::to_string(tick) + ": " + late + limit);
}

bool Server::Published(std::int64_t tick) {
  const std::lock_guard lock(mutex_);
  return published_ >= tick;
}

}  // namespace mascot
