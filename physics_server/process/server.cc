#include "physics_server/process/server.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "experiment/processes.h"

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

namespace {

TickProtocol::Rules RulesOf(const Experiment& experiment) {
  TickProtocol::Rules rules{.agents = experiment.size(),
                            .last_tick = experiment.ticks(),
                            .period_s = experiment.period_s(),
                            .agent_timeout_s = experiment.run.agent_timeout_s,
                            .recorder_window = kRecorderWindow};
  rules.realtime = experiment.run.mode == Mode::kRealtime;
  if (rules.realtime) rules.pace = experiment.run.speed;  // of lockstep, the recorder says it
  return rules;
}

}  // namespace

Server::Server(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      join_list_(experiment.size(), experiment.run.start_timeout_s),
      ticks_(RulesOf(experiment)),
      world_(experiment),
      live_(experiment, nullptr, /*checked=*/true),
      commands_(static_cast<std::size_t>(experiment.size())),
      pace_(experiment.control.rate_hz),
      events_(domain, Topic::Event()),
      event_readers_(static_cast<int>(AgentProcesses(experiment).size()) + 1),
      requests_(domain, Topic::Request()),
      delivery_(
          MakeDelivery(domain, experiment, [this](std::span<const Delivery::Answer> answers) { OnAnswers(answers); })),
      status_reader_(
          domain, Topic::Status(),
          [this](const mascot_msgs::msg::Status& status, const Sender& sender) { OnStatus(status, sender.process); }),
      request_reader_(domain, Topic::Request(), [this](const mascot_msgs::msg::Request& request, const Sender& sender) {
        if (sender.process == kOrchestrator) OnRequest(request);
      }) {}

void Server::Run() {
  AwaitEveryone();
  try {
    RunTicks();
  } catch (const Ended& ended) {
    Report();
    if (ended.signal() == 0) lifecycle_.SetFinal(Life::kEnded);  // after a signal there may be no readers left
    throw;
  } catch (...) {
    Report();
    throw;
  }
  Report();
}

void Server::Report() {
  const std::lock_guard lock(mutex_);
  delivery_->Finish();
  lifecycle_.Report(static_cast<std::uint64_t>(std::max<std::int64_t>(ticks_.published(), 0)), pace_.Result(),
                    world_.contacts());
}

// --- start ----------------------------------------------------------------------------------------------

void Server::AwaitEveryone() {
  BeginJoining();
  lifecycle_.Set(Life::kMatching);
  for (;;) {
    lifecycle_.Wait(50ms);
    const JoinList::Next next = LookAtJoinList();
    if (next == JoinList::Next::kStart) return;
    if (next == JoinList::Next::kAsk) AskForReports();
  }
}

void Server::BeginJoining() {
  const std::lock_guard lock(mutex_);
  join_list_.Begin(WallClock::now());
}

JoinList::Next Server::LookAtJoinList() {
  const bool matched = Matched();  // without our lock: it takes the locks of readers and writers
  const std::lock_guard lock(mutex_);
  const JoinList::Next next = join_list_.Look(WallClock::now(), matched);
  if (next == JoinList::Next::kFail) throw std::runtime_error(join_list_.Failure());
  return next;
}

void Server::AskForReports() {
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(Ask::kReport));
  requests_.Write(request);
}

bool Server::Matched() const {
  return request_reader_.matched() >= 1 && events_.matched() >= event_readers_ && delivery_->Matched();
}

void Server::OnStatus(const mascot_msgs::msg::Status& status, const std::string& from) {
  const Life life = CheckedLife(status, experiment_.ticks());
  const bool ready = life == Life::kReady || life == Life::kRunning;
  const std::lock_guard lock(mutex_);
  if (from == kOrchestrator) {
    join_list_.OnRecorder(ready);
    if (life == Life::kReady && ticks_.published() < 0) ticks_.gate().SetPace(status.pace());
    Do(ticks_.OnRecorded(static_cast<std::int64_t>(status.tick())));
  } else if (const auto agents = AgentsOf(from)) {
    join_list_.OnAgents(*agents, ready);
  }
}

// --- ticks ----------------------------------------------------------------------------------------------

void Server::Do(const TickProtocol::Actions& actions) {
  if (actions.step) world_.Step(commands_);
  if (actions.publish) Publish();
  if (actions.ask) delivery_->AskAgain();
  if (ticks_.finished()) delivery_->Finish();
  if (actions.wake) lifecycle_.Wake();
}

void Server::Publish() {
  PublishEvents();
  delivery_->Publish(world_, live_.count());
}

void Server::PublishEvents() {
  const int before = live_.count();
  while (next_event_ < experiment_.events.size() && experiment_.events[next_event_].tick == world_.tick())
    PublishEvent(experiment_.events[next_event_++]);
  for (const Event& event : std::exchange(by_hand_, {})) PublishEvent(event);
  if (live_.count() > before) world_.Adopt(*live_.now());
}

void Server::PublishEvent(const Event& event) {
  live_.Take(event);
  if (event.set.contains("run.pace")) {
    ticks_.gate().SetPace(live_.now()->run.pace.value_or(0));
    progress_is_new_ = true;
    lifecycle_.Wake();
  }
  mascot_msgs::msg::Event sample;
  ToWire(event.tick, experiment_.control.rate_hz, live_.count(), event.Toml(), sample);
  events_.Write(sample);
}

void Server::OnRequest(const mascot_msgs::msg::Request& request) {
  if (request.number() == 0) return;  // for Lifecycle
  {
    const std::lock_guard lock(mutex_);
    if (request.number() > progress_.request) {
      progress_.request_tick = CarryOut(request);
      progress_.request = request.number();
    }
  }
  ReportProgress();
  lifecycle_.Wake();
}

std::int64_t Server::CarryOut(const mascot_msgs::msg::Request& request) {
  const std::int64_t next = ticks_.published() + 1;
  if (ticks_.finished() || lifecycle_.stop_requested() || next > experiment_.ticks()) return kOver;
  switch (static_cast<Ask>(request.kind())) {
    case Ask::kPause:
      ticks_.gate().Pause();
      break;
    case Ask::kResume:
      ticks_.gate().Resume();
      break;
    case Ask::kStep:
      ticks_.gate().Step(static_cast<std::int64_t>(request.value()));
      break;
    case Ask::kPace:
      ticks_.gate().SetPace(request.value());
      break;
    case Ask::kEvent:
      if (static_cast<double>(next) >= request.value()) return kTooLate;
      by_hand_.push_back(EventFrom(next, request.toml(), experiment_.size(), "event by hand"));
      break;
    default:
      throw std::runtime_error("an unknown kind of request: " + std::to_string(request.kind()));
  }
  return next;
}

void Server::ReportProgress() {
  RunProgress progress;
  {
    const std::lock_guard lock(mutex_);
    progress = progress_;
    progress.tick = ticks_.published();
    progress.paused = ticks_.gate().paused();
    progress.pace = ticks_.gate().pace();
  }
  lifecycle_.Report(progress);
}

void Server::OnAnswers(std::span<const Delivery::Answer> answers) {
  const std::lock_guard lock(mutex_);
  TickProtocol::Actions all;
  for (const auto& [id, tick, actuator] : answers) {
    const TickProtocol::Actions actions = ticks_.OnCommand(id, tick, lifecycle_.stop_requested());
    if (actions.take) commands_[static_cast<std::size_t>(id - 1)] = actuator;
    all.step |= actions.step;
    all.publish |= actions.publish;
    all.wake |= actions.wake;
  }
  Do(all);
  if (!all.publish) delivery_->CompleteRow();
}

void Server::RunTicks() {
  Start();
  for (;;) {
    const TickProtocol::Turn turn = Look();
    if (!turn.next_deadline) return;
    const bool is_long = turn.held && *turn.next_deadline - WallClock::now() > 100ms;
    if (progress_is_new_.exchange(false) || is_long) ReportProgress();
    lifecycle_.Wait(*turn.next_deadline - WallClock::now());
  }
}

void Server::Start() {
  const std::lock_guard lock(mutex_);
  lifecycle_.Set(Life::kRunning);
  Do(ticks_.Start());
}

TickProtocol::Turn Server::Look() {
  const auto now = WallClock::now();
  const std::lock_guard lock(mutex_);
  const TickProtocol::Turn turn = ticks_.Look(now, lifecycle_.stop_requested());
  if (turn.due) MeasureCommands();
  if (!turn.failure.empty()) throw std::runtime_error(turn.failure);
  Do(turn.actions);
  if (turn.due) pace_.AddTick(std::chrono::duration<double>(WallClock::now() - *turn.due).count());
  return turn;
}

void Server::MeasureCommands() {
  for (int id = 1; id <= experiment_.size(); ++id)
    pace_.AddCommand(id, world_.tick(), world_.tick() - ticks_.answered(id));
}

}  // namespace mascot
