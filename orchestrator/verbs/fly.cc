#include "orchestrator/verbs/fly.h"

#include <utility>

#include "agent/laws/laws.h"
#include "agent/user_code/last_words.h"
#include "bus/leave.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/inprocess.h"
#include "system/interruptions.h"

namespace mascot {
namespace {

/// The usual values of keys that change nothing in what is flown.
std::vector<Override> UsualDelivery() {
  return {{.key = "network.domain", .value = "\"auto\""},     {.key = "network.agents_per_process", .value = "1"},
          {.key = "network.delivery", .value = "\"topics\""}, {.key = "network.ros_view", .value = "false"},
          {.key = "hosts", .value = "", .removes = true},     {.key = "run.pace", .value = "", .removes = true}};
}

}  // namespace

void RefuseEngine(const std::string& engine, const Experiment& experiment) {
  if (engine == kOverDds) return RefuseTooManyProcesses(experiment);
  if (experiment.run.mode == Mode::kRealtime)  // in one process there is no pacing
    throw ConfigError({"--engine inprocess: expected run.mode = \"lockstep\", got \"realtime\""});
  if (experiment.network.ros_view)  // there is no DDS
    throw ConfigError({"--engine inprocess: expected network.ros_view = false, got true"});
}

Flight::Flight(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
               const std::vector<RowSink*>& sinks, RunRequests* requests, Console& console, StopSignal& stop,
               RosSource* ros)
    : experiment_(experiment), sinks_(sinks), requests_(requests), console_(console), stop_(stop) {
  if (engine == kOverDds)
    dds_.emplace(experiment, folder, sinks, requests, console, stop, ros);
  else if (FliesCodeOfUsers(experiment))
    janitor_.emplace();
}

void Flight::LeaveIfKilled(const std::string& path, const std::string& text) {
  if (dds_) dds_->LeaveIfKilled(path, text);
  if (janitor_) janitor_->LeaveWords(path, text);
}

EngineResult Flight::Fly() {
  if (dds_) return dds_->Fly();
  const Interruptions interruptions(stop_, console_, [](int code) {
    const char* const reason = "a second signal has ended the process at once";
    LastWords::Leave(&reason, 1, code);
  });
  EngineResult result = RunInProcess(
      experiment_, sinks_, [&] { return interruptions.signal() == 0; }, requests_);
  result.signal = interruptions.signal();
  return result;
}

void Flight::End() {
  if (janitor_) janitor_->Dismiss();  // the orchestrator kills what laws have started at its own end
  if (dds_) hangs_ = !dds_->End();
}

void Flight::LeaveIfItHangs(int code) const {
  if (hangs_) LeaveNow({.code = code, .process = "orchestrator"});  // its threads use what would be destroyed
}

std::vector<Override> DeliveryOf(const Experiment& experiment) {
  const auto& network = experiment.network;
  return {{.key = "network.domain", .value = network.domain < 0 ? "\"auto\"" : std::to_string(network.domain)},
          {.key = "network.agents_per_process", .value = std::to_string(network.agents_per_process)},
          {.key = "network.delivery", .value = ToToml(Value{std::string(kDeliveries.Name(network.delivery))})}};
}

std::string Changed(const Experiment& experiment, const std::vector<Override>& changes) {
  return LoadExperiment(Section::FromText(experiment.resolved, "config.toml", changes), experiment.run.name,
                        /*checked=*/true)
      .resolved;
}

Experiment WithEvents(const Experiment& experiment, const std::vector<Event>& by_hand) {
  if (by_hand.empty()) return experiment;
  std::string text = experiment.resolved;
  for (const Event& event : by_hand)
    text = WithEvent(std::move(text), event.tick, experiment.control.rate_hz, event.Toml());
  return LoadExperiment(Section::FromText(text, "config.toml"), experiment.run.name, /*checked=*/true);
}

std::string WithoutDelivery(const Experiment& experiment) {
  const auto& network = experiment.network;
  const bool is_usual = network.domain < 0 && network.agents_per_process == 1 &&
                        network.delivery == Delivery::kTopics && !network.ros_view && !experiment.run.pace &&
                        experiment.hosts.empty();
  return is_usual ? experiment.resolved : Changed(experiment, UsualDelivery());
}

std::string WithoutEvents(const Experiment& experiment) {
  if (experiment.events.empty()) return WithoutDelivery(experiment);
  std::vector<Override> changes = UsualDelivery();
  changes.push_back({.key = "events", .value = "[]"});
  return Changed(experiment, changes);
}

}  // namespace mascot
