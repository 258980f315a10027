#include "orchestrator/engines/dds/run_links.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "base/utf8.h"
#include "experiment/processes.h"

namespace mascot {

using namespace std::chrono_literals;

namespace {

const char* Text(Life life) {
  switch (life) {
    case Life::kWaiting:
      return "waits for the experiment";
    case Life::kMatching:
      return "looks for its peers";
    case Life::kReady:
      return "is ready";
    case Life::kRunning:
      return "runs";
    case Life::kDone:
      return "is done";
    case Life::kFailed:
      return "has failed";
    case Life::kEnded:
      return "has ended";
  }
  return "says something unknown";
}

const char* Text(Ask ask) {
  switch (ask) {
    case Ask::kReport:
      return "report";
    case Ask::kStop:
      return "stop";
    case Ask::kEnd:
      return "end";
    case Ask::kPause:
      return "pause";
    case Ask::kResume:
      return "resume";
    case Ask::kStep:
      return "step";
    case Ask::kPace:
      return "pace";
    case Ask::kEvent:
      return "event";
    case Ask::kLose:
      return "lose";
    case Ask::kStart:
      return "start";
    case Ask::kLand:
      return "land";
    case Ask::kStopMotors:
      return "stop motors";
  }
  return "unknown";
}

mascot_msgs::msg::Experiment MessageOf(const Experiment& experiment) {
  mascot_msgs::msg::Experiment message;
  message.name(experiment.run.name);
  message.toml(experiment.resolved);
  return message;
}

/// `digest`: of the experiment as it is handed out.
ProcessTable::Rules ProcessTableRules(const Experiment& experiment, std::uint64_t digest) {
  ProcessTable::Rules rules{
      .processes = {kPhysicsServer}, .external = {}, .experiment = digest, .last_tick = experiment.ticks()};
  for (const AgentRange& agents : AgentProcesses(experiment)) rules.processes.push_back(ProcessName(agents));
  for (const int vehicle : AgentsWithVehicles(experiment)) rules.processes.push_back(VehicleName(vehicle));
  for (const AgentConfig& agent : experiment.agents) rules.external.push_back(agent.external);
  return rules;
}

/// What is asked of the physics server for a request about its ticks.
Ask AskOf(Request::Kind kind) {
  switch (kind) {
    case Request::Kind::kPause:
      return Ask::kPause;
    case Request::Kind::kResume:
      return Ask::kResume;
    case Request::Kind::kStep:
      return Ask::kStep;
    case Request::Kind::kPace:
      return Ask::kPace;
    case Request::Kind::kEvent:
      return Ask::kEvent;
    default:
      throw std::logic_error("no request about ticks");
  }
}

/// The lines of a logger go to a file.
class LogSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LogSink(LogFile file) : file_(std::move(file)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    file_.Write({line.data(), line.size()});
  }
  void flush_() override {}

  LogFile file_;
};

ProcessTable::Time Now() { return std::chrono::steady_clock::now(); }

}  // namespace

RunLinks::RunLinks(Domain& domain, const Peers& peers, const Experiment& experiment, LogFile log,
                   std::function<void()> wake)
    : peers_(peers),
      wake_(std::move(wake)),
      log_("orchestrator", std::make_shared<LogSink>(std::move(log))),
      message_(MessageOf(experiment)),
      process_table_(ProcessTableRules(experiment, DigestOf(message_))),
      experiments_(domain, Topic::Experiment()),
      requests_(domain, Topic::Request()),
      recorder_(domain, Topic::Status()),
      status_(domain, Topic::Status(),
              [this](const Status& status, const Sender& sender) { OnStatus(status, sender.process); }) {}

RunLinks::~RunLinks() {
  for (const std::string& line : peers_.Refusals()) log_.warn("{}", PlainLine(line));
}

void RunLinks::Note(const std::string& words) { log_.info("{}", PlainLine(words)); }

void RunLinks::HandOutExperiment() {
  {
    const std::lock_guard lock(mutex_);
    if (const auto version = peers_.version(); std::exchange(told_, version) != version)
      process_table_.WantExperiment();
    if (!process_table_.IsTimeToHandOut(Now())) return;
  }
  PublishExperiment();
}

void RunLinks::HandOutExperiment(std::int64_t from_tick, std::vector<mascot_msgs::msg::Event> events) {
  message_.from_tick(static_cast<std::uint64_t>(from_tick));
  message_.events(std::move(events));
  PublishExperiment();
}

void RunLinks::PublishExperiment() {
  message_.processes().clear();
  for (const auto& [process, key] : peers_.Places()) {
    message_.processes().emplace_back();
    message_.processes().back().name(process);
    message_.processes().back().bits(key.bits());
    message_.processes().back().mask(key.mask());
  }
  experiments_.Write(message_);
  Note(fmt::format("experiment '{}' handed out", message_.name()));
}

void RunLinks::SayReady(double pace, bool paused) {
  {
    const std::lock_guard lock(mutex_);
    if (!process_table_.IsTimeForHello(Now())) return;
  }
  Status status;
  status.process("recorder");
  status.state(static_cast<std::uint8_t>(Life::kReady));
  status.pace(pace);
  status.paused(paused);
  recorder_.Write(status);
}

void RunLinks::Confirm(std::int64_t rows) {
  Status status;
  status.process("recorder");
  status.state(static_cast<std::uint8_t>(Life::kRunning));
  status.tick(static_cast<std::uint64_t>(rows));
  recorder_.Write(status);
}

void RunLinks::Ask(mascot::Ask ask, const std::string& reason) {
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(ask));
  request.reason(reason);
  requests_.Write(request);
  Note(fmt::format("request: {} ({})", Text(ask), reason));
}

void RunLinks::Ask(const Fleet::Order& order) {
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(order.ask));
  request.agents(order.agents);
  request.reason(order.reason);
  requests_.Write(request);
  Note(fmt::format("request of vehicles {}: {} ({})", fmt::join(order.agents, ", "), Text(order.ask), order.reason));
}

void RunLinks::Steer(const RunRequests::Order& order, std::uint32_t number) {
  const bool is_new = std::exchange(newest_request_, number) != number;
  if (!is_new && Now() < next_request_) return;
  next_request_ = Now() + 200ms;
  const mascot::Ask ask = AskOf(order.kind);
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(ask));
  request.number(number);
  request.value(order.number);
  if (order.event) request.toml(order.event->Toml());
  requests_.Write(request);
  if (is_new) Note(fmt::format("request {}: {} {} {}", number, Text(ask), order.number, request.toml()));
}

void RunLinks::Lose(AgentRange agents) {
  constexpr auto kBetween = 200ms;
  ProcessTable::Time& next = next_losses_[ProcessName(agents)];
  const auto now = Now();
  if (now < next) return;
  next = now + kBetween;
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(Ask::kLose));
  for (int id = agents.first; id <= agents.last; ++id) request.agents().push_back(static_cast<std::uint32_t>(id));
  Note("asks the physics server to go on without " + ProcessName(agents));
  requests_.Write(request);
}

std::int64_t RunLinks::server_words() const {
  const std::lock_guard lock(mutex_);
  return server_words_;
}

void RunLinks::OnStatus(const Status& status, const std::string& from) {
  if (from == kOrchestrator) return;  // our own, as the recorder
  const std::lock_guard lock(mutex_);
  const ProcessTable::News news = process_table_.OnStatus(from, status);
  if (from == kPhysicsServer) ++server_words_;
  if (news.changed)
    Note(fmt::format("{} {}, tick {} {}", from, Text(static_cast<Life>(status.state())), status.tick(),
                     status.reason().to_string()));
  if (news.wake) wake_();
}

std::optional<RunLinks::Status> RunLinks::StatusOf(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  return process_table_.Of(process);
}

bool RunLinks::HaveTheExperiment() const {
  const std::lock_guard lock(mutex_);
  return process_table_.HaveTheExperiment();
}

std::string RunLinks::Missing() const {
  const std::lock_guard lock(mutex_);
  return process_table_.Missing();
}

}  // namespace mascot
