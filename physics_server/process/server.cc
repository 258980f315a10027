#include "physics_server/process/server.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "experiment/processes.h"
#include "physics_server/process/agents_text.h"

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

namespace {

/// How often fresh processes are asked whether they are ready.
constexpr auto kAskFreshEvery = 50ms;

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
      join_list_(experiment.size(), experiment.run.start_timeout_s, !AgentsWithVehicles(experiment).empty()),
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
      }) {
  for (const AgentConfig& agent : experiment.agents)
    if (agent.vehicle)
      measured_readers_.push_back(std::make_unique<Reader<StateType>>(
          domain, Topic::Measured(agent.id),
          [this, id = agent.id](const mascot_msgs::msg::AgentState& state) { OnMeasured(id, state); }));
}

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
  lifecycle_.Report(static_cast<std::uint64_t>(std::max<std::int64_t>(ticks_.last_whole(), 0)), pace_.Result(),
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
  return request_reader_.matched() >= 1 && events_.matched() >= event_readers_ && delivery_->Matched() &&
         std::ranges::all_of(measured_readers_, [](const auto& reader) { return reader->matched() >= 1; });
}

void Server::OnStatus(const mascot_msgs::msg::Status& status, const std::string& from) {
  const Life life = CheckedLife(status, experiment_.ticks());
  const bool ready = life == Life::kReady || life == Life::kRunning;
  const std::lock_guard lock(mutex_);
  if (from == kOrchestrator) {
    join_list_.OnRecorder(ready);
    if (life == Life::kReady && ticks_.published() < 0) {
      ticks_.gate().SetPace(status.pace());
      if (status.paused()) ticks_.gate().Pause();
    }
    Do(ticks_.OnRecorded(static_cast<std::int64_t>(status.tick())));
  } else if (const auto agents = AgentsOf(from)) {
    join_list_.OnAgents(*agents, ready);
    const bool is_fresh = restart_ && std::cmp_equal(status.from_tick(), ticks_.published() + 1);
    if (life == Life::kReady && is_fresh && std::ranges::find(restart_->ready, *agents) == restart_->ready.end()) {
      restart_->ready.push_back(*agents);
      lifecycle_.Wake();
    }
  }
}

// --- ticks ----------------------------------------------------------------------------------------------

void Server::Do(const TickProtocol::Actions& actions) {
  if (actions.step) Step();
  if (actions.step && restart_) {  // now it can be said whom it awaits
    progress_is_new_ = true;
    lifecycle_.Wake();
  }
  if (actions.publish) Publish();
  if (actions.ask) delivery_->AskAgain();
  if (ticks_.finished()) delivery_->Finish();
  if (actions.wake) lifecycle_.Wake();
}

void Server::Step() {
  for (const auto& [id, motion] : measured_) world_.Move(id, motion);
  world_.Step(commands_);
}

void Server::OnMeasured(int id, const mascot_msgs::msg::AgentState& state) {
  const std::lock_guard lock(mutex_);
  measured_.insert_or_assign(id, FromWire(state));
}

void Server::Publish() {
  PublishEvents();
  LoseUnanswered();
  delivery_->Publish(world_, live_.count());
  LookForRestarts();
}

void Server::LoseUnanswered() {
  const std::int64_t next = world_.tick() + 1;
  for (std::size_t k = next_event_; k < experiment_.events.size() && experiment_.events[k].tick == next; ++k) {
    const auto& fault = experiment_.events[k].fault;
    if (!fault || !fault->unanswered) continue;
    delivery_->Lose(fault->agent);
    if (ticks_.Lose(fault->agent, /*unanswered=*/true).wake) lifecycle_.Wake();
  }
}

std::vector<int> Server::RestartsAhead() const {
  const std::int64_t next = ticks_.published() + 1;
  std::vector<int> agents;
  const auto add = [&](const Event& event) {
    if (event.restart) agents.push_back(*event.restart);
  };
  for (std::size_t k = next_event_; k < experiment_.events.size() && experiment_.events[k].tick == next; ++k)
    add(experiment_.events[k]);
  std::ranges::for_each(by_hand_, add);
  std::ranges::for_each(live_.RestartsAt(next), add);
  return agents;
}

void Server::LookForRestarts() {
  const std::vector<int> agents = RestartsAhead();
  if (agents.empty() || ticks_.published() >= experiment_.ticks()) return;
  const auto restarts = [&](int id) { return std::ranges::find(agents, id) != agents.end(); };
  for (const AgentRange& process : AgentProcesses(experiment_)) {
    bool any = false, others_live = false;
    for (int id = process.first; id <= process.last; ++id) {
      any = any || restarts(id);
      others_live = others_live || (!restarts(id) && !live_.current().agent(id).faults.is_lost());
    }
    if (!any || others_live) continue;  // the agent begins anew in the process of the others
    if (!restart_) restart_ = Restart{};
    if (std::ranges::find(restart_->processes, process) == restart_->processes.end())
      restart_->processes.push_back(process);
  }
  if (!restart_) return;
  ticks_.Hold();
  progress_is_new_ = true;
  lifecycle_.Wake();
}

void Server::AwaitRestarts() {
  std::vector<AgentRange> ready;
  bool asks = false;
  {
    const std::lock_guard lock(mutex_);
    if (!restart_) return;
    if (WallClock::now() - restart_->since > std::chrono::duration<double>(experiment_.run.start_timeout_s)) {
      std::vector<int> missing;
      for (const AgentRange& process : restart_->processes)
        if (std::ranges::find(restart_->ready, process) == restart_->ready.end()) missing.push_back(process.first);
      throw std::runtime_error(
          "tick " + std::to_string(ticks_.published() + 1) + ": fresh processes of " + AgentsText(missing) +
          " were not ready within run.start_timeout_s = " + ShortestFloat(experiment_.run.start_timeout_s) + " s");
    }
    asks = WallClock::now() > restart_->ask_again && restart_->ready.size() < restart_->processes.size();
    if (asks) restart_->ask_again = WallClock::now() + kAskFreshEvery;
    if (restart_->ready.size() == restart_->processes.size()) ready = restart_->ready;
  }
  if (asks) {
    AskForReports();  // what they said before we knew them is lost
    ReportProgress();
  }
  if (ready.empty()) return;
  for (const AgentRange& process : ready)  // without the mutex: it takes the locks of readers and writers
    if (!events_.HasReaderOf(ProcessName(process)) || !delivery_->Matched(process)) return;
  const std::lock_guard lock(mutex_);
  if (restart_->processes.size() > ready.size()) return;
  restart_.reset();
  progress_is_new_ = true;
  Do(ticks_.Release());
}

void Server::PublishEvents() {
  std::vector<Event> events;
  while (next_event_ < experiment_.events.size() && experiment_.events[next_event_].tick == world_.tick())
    events.push_back(experiment_.events[next_event_++]);
  std::ranges::move(std::exchange(by_hand_, {}), std::back_inserter(events));
  const int before = live_.count();
  for (const Event& event : events) TakeEvent(event);
  for (Event& event : live_.RestartsAt(world_.tick())) {
    TakeEvent(event);
    events.push_back(std::move(event));
  }
  if (events.empty()) return;
  if (const std::string loss = LossThatEndsTheRun(live_.current()); !loss.empty())
    throw std::runtime_error("tick " + std::to_string(world_.tick()) + ": " + loss);
  for (std::size_t k = 0; k < events.size(); ++k) PublishEvent(events[k], before + 1 + static_cast<int>(k));
  world_.Adopt(*live_.now());
}

void Server::TakeEvent(const Event& event) {
  live_.Take(event);
  if (!event.set.contains("run.pace")) return;
  ticks_.gate().SetPace(live_.now()->run.pace.value_or(0));
  progress_is_new_ = true;
  lifecycle_.Wake();
}

void Server::PublishEvent(const Event& event, int number) {
  delivery_->Take(event);
  if (event.fault && event.fault->IsLoss() && ticks_.Lose(event.fault->agent, /*unanswered=*/false).wake)
    lifecycle_.Wake();
  if (event.restart) ticks_.Regain(*event.restart);
  mascot_msgs::msg::Event sample;
  ToWire(event.tick, experiment_.control.rate_hz, number, event.Toml(), sample);
  events_.Write(sample);
}

void Server::Lose(std::span<const int> agents, FaultKind kind) {
  const std::int64_t newest = ticks_.published();
  for (const int id : agents) {
    const auto is_it = [id](const Event& event) {
      return event.fault && event.fault->IsLoss() && event.fault->agent == id;
    };
    const auto holds_it = [id](AgentRange process) { return process.Holds(id); };
    if (restart_ && std::ranges::any_of(restart_->processes, holds_it)) continue;  // another one will be started
    if (live_.current().agent(id).faults.is_lost() || std::ranges::any_of(by_hand_, is_it)) continue;
    const bool has_answered = delivery_->Lose(id) || ticks_.answered(id) == newest;
    const bool unanswered = !has_answered && experiment_.run.mode == Mode::kLockstep;
    if (newest == experiment_.ticks()) {
      if (has_answered) continue;
      throw std::runtime_error("tick " + std::to_string(newest) + ", the last: agent " + std::to_string(id) +
                               " is lost, and has not answered");
    }
    const Fault fault{.agent = id, .kind = kind, .unanswered = unanswered};
    by_hand_.push_back({.tick = newest + 1, .fault = fault, .where = "agent " + std::to_string(id)});
    if (!has_answered && ticks_.Lose(id, unanswered).wake) lifecycle_.Wake();
  }
}

void Server::OnRequest(const mascot_msgs::msg::Request& request) {
  if (static_cast<Ask>(request.kind()) == Ask::kLose) {
    const std::vector<int> agents(request.agents().begin(), request.agents().end());
    const std::lock_guard lock(mutex_);
    return Lose(agents, FaultKind::kKill);
  }
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
      LookForRestarts();
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
    progress.events = live_.count();
    if (restart_ && world_.tick() > ticks_.published())  // all have answered: nobody needs the processes before them
      for (const AgentRange& process : restart_->processes) progress.awaited.push_back(process.first);
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
    AwaitRestarts();
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
  for (const auto& [id, motion] : measured_) world_.Place(id, motion);
  Do(ticks_.Start());
}

TickProtocol::Turn Server::Look() {
  const auto now = WallClock::now();
  const std::lock_guard lock(mutex_);
  TickProtocol::Turn turn = ticks_.Look(now, lifecycle_.stop_requested());
  if (turn.due) MeasureCommands();
  if (!turn.late.empty() && experiment_.run.on_agent_loss != OnAgentLoss::kAbort)
    Lose(turn.late, FaultKind::kHang);
  else if (!turn.failure.empty())
    throw std::runtime_error(turn.failure);
  Do(turn.actions);
  if (turn.due) pace_.AddTick(std::chrono::duration<double>(WallClock::now() - *turn.due).count());
  return turn;
}

void Server::MeasureCommands() {
  for (int id = 1; id <= experiment_.size(); ++id)
    if (!live_.current().agent(id).faults.is_lost())
      pace_.AddCommand(id, world_.tick(), world_.tick() - ticks_.answered(id));
}

}  // namespace mascot
