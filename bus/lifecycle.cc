#include "bus/lifecycle.h"

#include <algorithm>
#include <utility>

#include "base/utf8.h"

namespace mascot {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

std::string NoExperiment(std::chrono::seconds timeout) {
  return "no experiment came within " + std::to_string(timeout.count()) +
         " s: is an orchestrator running in this domain?";
}

Lifecycle::Lifecycle(Domain& domain, Peers& peers, StopSignal& stop, const std::string& process, int agent)
    : stop_(stop),
      domain_(domain),
      peers_(peers),
      status_writer_(domain, Topic::Status()),
      experiment_reader_(domain, Topic::Experiment(),
                         [this](const mascot_msgs::msg::Experiment& experiment) { OnExperiment(experiment); }),
      request_reader_(domain, Topic::Request(), [this](const mascot_msgs::msg::Request& request, const Sender& sender) {
        OnRequest(request, sender.process);
      }) {
  status_.process(process);
  status_.agent(static_cast<std::uint32_t>(agent));
}

mascot_msgs::msg::Experiment Lifecycle::AwaitExperiment(std::chrono::seconds timeout, std::int64_t from_tick) {
  const auto deadline = Clock::now() + timeout;
  int listeners = 0;
  for (auto ask_again = Clock::now(); Clock::now() < deadline;) {
    {
      const std::lock_guard lock(mutex_);
      if (experiment_ && std::cmp_greater_equal(experiment_->from_tick(), from_tick)) {
        status_.from_tick(experiment_->from_tick());
        status_.experiment(DigestOf(*experiment_));  // what this process will fly, whatever comes later
        return *experiment_;
      }
    }
    const int before = std::exchange(listeners, status_writer_.matched());
    if (listeners > before || Clock::now() >= ask_again) {
      Set(Life::kWaiting);
      ask_again = Clock::now() + 200ms;
    }
    Wait(ask_again - Clock::now());
  }
  throw std::runtime_error(NoExperiment(timeout));
}

void Lifecycle::Set(Life life, const std::string& reason) {
  {
    const std::lock_guard lock(mutex_);
    status_.state(static_cast<std::uint8_t>(life));
    status_.reason(std::string(CutUtf8(reason, 1024)));
  }
  Publish();
}

void Lifecycle::SetFinal(Life life, const std::string& reason) {
  Set(life, reason);
  status_writer_.AwaitReaders(3s);
}

void Lifecycle::Report(std::uint64_t tick, const Pacing& pacing, const Contacts& contacts) {
  {
    const std::lock_guard lock(mutex_);
    status_.tick(tick);
    ToWire(pacing, contacts, status_);
  }
  Publish();
}

void Lifecycle::Report(const RunProgress& progress) {
  {
    const std::lock_guard lock(mutex_);
    status_.tick(static_cast<std::uint64_t>(std::max<std::int64_t>(progress.tick, 0)));
    status_.request(progress.request);
    status_.request_tick(progress.request_tick);
    status_.paused(progress.paused);
    status_.pace(progress.pace);
    status_.events(static_cast<std::uint32_t>(progress.events));
    status_.awaited().assign(progress.awaited.begin(), progress.awaited.end());
  }
  Publish();
}

void Lifecycle::Wait(std::chrono::nanoseconds timeout) {
  const int signal = stop_.Within(timeout);
  domain_.RethrowFailure();
  if (signal != 0) throw Ended(signal);
  if (end_requested_) throw Ended(0);
  if (report_requested_.exchange(false)) Publish();
  // Only the orchestrator writes /experiment: while no writer is matched, it is not in the domain.
  if (experiment_reader_.matched() > 0)
    orchestrator_seen_ = true;
  else if (orchestrator_seen_)
    throw std::runtime_error("the orchestrator has gone");
}

void Lifecycle::OnExperiment(const mascot_msgs::msg::Experiment& experiment) {
  for (const mascot_msgs::msg::Process& process : experiment.processes())
    peers_.Know(process.name().to_string(), ProcessKey(process.bits(), process.mask()));
  {
    const std::lock_guard lock(mutex_);
    experiment_ = experiment;
  }
  domain_.Wake();
}

void Lifecycle::OnRequest(const mascot_msgs::msg::Request& request, const std::string& from) {
  const auto ask = static_cast<Ask>(request.kind());
  if (from != kOrchestrator && ask != Ask::kReport) return;
  switch (ask) {
    case Ask::kReport:
      report_requested_ = true;
      break;
    case Ask::kStop:
      stop_requested_ = true;
      break;
    case Ask::kEnd:
      end_requested_ = true;
      break;
    default:  // of the physics server's ticks
      return;
  }
  domain_.Wake();
}

void Lifecycle::Publish() {
  mascot_msgs::msg::Status status;
  {
    const std::lock_guard lock(mutex_);
    status = status_;
  }
  status_writer_.Write(status);
}

}  // namespace mascot
