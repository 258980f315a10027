#include "orchestrator/engines/dds/hub.h"

#include <spdlog/sinks/basic_file_sink.h>

#include <utility>

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
  }
  return "unknown";
}

}  // namespace

Hub::Hub(Domain& domain, const Experiment& experiment, const RunFolder& folder, std::function<void()> wake)
    : experiment_(experiment),
      wake_(std::move(wake)),
      log_("orchestrator", std::make_shared<spdlog::sinks::basic_file_sink_mt>(folder.Log("orchestrator").string())),
      experiments_(domain, Topic::Experiment()),
      requests_(domain, Topic::Request()),
      recorder_(domain, Topic::Status()),
      status_(domain, Topic::Status(), [this](const Status& status) { OnStatus(status); }) {
  log_.flush_on(spdlog::level::info);
  message_.name(experiment.run.name);
  message_.toml(experiment.resolved);
}

void Hub::HandOutExperiment() {
  // Everybody hears it each time: not once for each of a hundred agents that ask at once.
  if (WallClock::now() < next_hand_out_) return;
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(experiment_wanted_, false)) return;
  }
  experiments_.Write(message_);
  next_hand_out_ = WallClock::now() + 100ms;
  log_.info("experiment '{}' handed out", message_.name());
}

void Hub::SayReady() {
  if (WallClock::now() < next_hello_) return;
  next_hello_ = WallClock::now() + 200ms;
  Status status;
  status.process("recorder");
  status.state(static_cast<std::uint8_t>(Life::kReady));
  recorder_.Write(status);
}

void Hub::Confirm(std::int64_t rows) {
  Status status;
  status.process("recorder");
  status.state(static_cast<std::uint8_t>(Life::kRunning));
  status.tick(static_cast<std::uint64_t>(rows));
  recorder_.Write(status);
}

void Hub::Ask(mascot::Ask ask, const std::string& reason) {
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(ask));
  request.reason(reason);
  requests_.Write(request);
  log_.info("request: {} ({})", Text(ask), reason);
}

void Hub::OnStatus(const Status& status) {
  const auto life = static_cast<Life>(status.state());
  const std::lock_guard lock(mutex_);
  auto& known = statuses_[status.process().to_string()];
  if (known.process().size() == 0 || known.state() != status.state())
    log_.info("{} {}, tick {} {}", status.process().to_string(), Text(life), status.tick(),
              status.reason().to_string());
  known = status;
  experiment_wanted_ |= life == Life::kWaiting;
  const bool external = status.agent() >= 1 && status.agent() <= experiment_.agents.size() &&
                        experiment_.agent(static_cast<int>(status.agent())).external;
  if (life == Life::kFailed && external)
    throw std::runtime_error(status.process().to_string() + " failed: " + status.reason().to_string());
  if (life == Life::kWaiting || life == Life::kDone) wake_();
}

std::optional<Hub::Status> Hub::StatusOf(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const auto found = statuses_.find(process);
  if (found == statuses_.end()) return std::nullopt;
  return found->second;
}

std::string Hub::Unheard() const {
  std::string names;
  auto check = [&](const std::string& process) {
    if (!StatusOf(process)) names += (names.empty() ? "nothing was heard of " : ", ") + process;
  };
  check("physics_server");
  for (const AgentRange& agents : AgentProcesses(experiment_)) check(ProcessName(agents));
  return names.empty() ? "not everybody has found everybody" : names;
}

}  // namespace mascot
