#include "orchestrator/recording/attached_experiment.h"

#include <algorithm>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

/// The usual values of keys that change nothing in what is flown.
std::vector<Override> UsualDelivery() {
  return {{.key = "network.domain", .value = "\"auto\""},   {.key = "network.agents_per_process", .value = "1"},
          {.key = "network.delivery", .value = "\"auto\""}, {.key = "network.ros_view", .value = "false"},
          {.key = "network.security", .value = "\"off\""},  {.key = "network.protection", .value = "\"none\""},
          {.key = "hosts", .value = "", .removes = true},   {.key = "run.pace", .value = "", .removes = true}};
}

}  // namespace

std::vector<Override> DeliveryOverrides(const Experiment& experiment) {
  const auto& network = experiment.network;
  return {{.key = "network.domain", .value = network.domain < 0 ? "\"auto\"" : std::to_string(network.domain)},
          {.key = "network.agents_per_process", .value = std::to_string(network.agents_per_process)},
          {.key = "network.delivery", .value = ToToml(Value{std::string(kDeliveries.Name(network.delivery))})}};
}

std::string WithOverrides(const Experiment& experiment, const std::vector<Override>& changes) {
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
                        network.delivery == DeliveryMode::kAuto && !network.ros_view && !network.is_secure() &&
                        !experiment.run.pace && experiment.hosts.empty();
  return is_usual ? experiment.resolved : WithOverrides(experiment, UsualDelivery());
}

std::string WithoutEvents(const Experiment& experiment) {
  if (experiment.events.empty()) return WithoutDelivery(experiment);
  std::vector<Override> changes = UsualDelivery();
  changes.push_back({.key = "events", .value = "[]"});
  return WithOverrides(experiment, changes);
}

std::string StoppedAfter(const Experiment& experiment, std::int64_t ticks) {
  ticks += std::ranges::any_of(experiment.events, [next = ticks + 1](const Event& event) {
    return event.tick == next && event.fault && event.fault->unanswered;
  });
  const double duration_s = experiment.time_s(ticks);
  std::vector<Override> changes{{.key = "run.duration_s", .value = ShortestFloat(duration_s)}};
  const Value file{Section::FromText(experiment.resolved, "config.toml").InTheFile()};
  if (const Value* events = file.Find("events")) {
    Value::List flown;
    for (const Value& event : std::get<Value::List>(events->data))
      if (event.Find("at_s")->Number() <= duration_s) flown.push_back(event);
    changes.push_back({.key = "events", .value = ToToml(Value{flown})});
  }
  return WithOverrides(experiment, changes);
}

}  // namespace mascot
