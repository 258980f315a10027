#include "orchestrator/engines/stepped_team.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "agent/laws/laws.h"
#include "base/fnv.h"
#include "orchestrator/engines/inprocess.h"

namespace mascot {
namespace {

bool AreEqual(std::span<const Override> some, std::span<const Override> others) {
  return std::ranges::equal(some, others, [](const Override& one, const Override& other) {
    return one.key == other.key && one.value == other.value && one.removes == other.removes;
  });
}

}  // namespace

SteppedTeam::SteppedTeam(std::string text, std::string path, std::vector<Override> overrides, Keeps keeps)
    : text_(std::move(text)), path_(std::move(path)), overrides_(std::move(overrides)), keeps_(keeps) {
  std::string all = text_;
  for (const Override& override : overrides_) all += '\n' + override.key + " = " + override.value;
  identity_ = Fnv1a(all);
}

std::shared_ptr<const Experiment> SteppedTeam::ExperimentWith(std::span<const Override> changes) const {
  if (experiment_ != nullptr && AreEqual(changes, history_.changes)) return experiment_;
  std::vector<Override> all = overrides_;
  all.insert(all.end(), changes.begin(), changes.end());
  auto experiment = std::make_shared<const Experiment>(LoadExperiment(text_, path_, all));
  RefuseInProcess(*experiment, path_);
  return experiment;
}

void SteppedTeam::Begin(std::shared_ptr<const Experiment> experiment, std::vector<Override> changes) {
  experiment_ = std::move(experiment);
  history_ = {.changes = std::move(changes)};
  restored_to_ = 0;
}

void SteppedTeam::Act(int id, std::span<const double> action) {
  if (id < 1 || id > experiment_->size())
    throw std::invalid_argument(fmt::format("expected an agent from 1 to {}, got {}", experiment_->size(), id));
  Give(id, action);
  if (keeps_ == Keeps::kNothing) return;
  history_.given.push_back({.tick = tick(), .agent = id, .numbers = action.size()});
  history_.actions.insert(history_.actions.end(), action.begin(), action.end());
}

Event SteppedTeam::EventByHand(const std::string& toml) const {
  constexpr const char* kByHand = "event by hand";
  if (is_over()) throw std::invalid_argument(std::string(kByHand) + ": the episode is over");
  Event event = EventFrom(tick() + 1, toml, experiment_->size(), kByHand);
  if (StandsElsewhere(toml))
    throw std::invalid_argument(std::string(kByHand) + ": expected keys of [[events]], got what no file has there");
  return event;
}

void SteppedTeam::RequireGoingOn() const {
  if (is_over()) throw std::runtime_error("the episode is over: expected a reset");
}

void SteppedTeam::Note(std::int64_t tick, std::string toml) {
  if (keeps_ == Keeps::kHistory) history_.events.push_back({tick, std::move(toml)});
}

SteppedTeam::Snapshot SteppedTeam::Save() const {
  if (keeps_ == Keeps::kNothing) throw std::logic_error("a snapshot of episodes without a history");
  Snapshot snapshot = history_;
  snapshot.of = identity_;
  snapshot.tick = tick();
  return snapshot;
}

void SteppedTeam::Restore(const Snapshot& snapshot, const std::function<void()>& look) {
  if (snapshot.of != identity_)
    throw std::invalid_argument("expected a snapshot of the same file, with the same keys set, got one of another");
  Reset(snapshot.changes);
  restored_to_ = snapshot.tick;
  AwaitStates();
  if (look) look();
  auto event = snapshot.events.begin();
  auto given = snapshot.given.begin();
  std::span<const double> numbers = snapshot.actions;
  const auto give = [&] {
    for (; given != snapshot.given.end() && given->tick == tick(); ++given) {
      Act(given->agent, numbers.first(given->numbers));
      numbers = numbers.subspan(given->numbers);
    }
    for (; event != snapshot.events.end() && event->tick == tick() + 1; ++event) Take(event->toml);
  };
  const auto next_stop = [&] {
    if (look) return tick() + 1;
    std::int64_t next = snapshot.tick;
    if (given != snapshot.given.end()) next = std::min(next, given->tick);
    if (event != snapshot.events.end()) next = std::min(next, event->tick - 1);
    return std::max(next, tick() + 1);
  };
  give();
  while (tick() < snapshot.tick) {
    GoTo(next_stop(), [] { return true; });
    if (look) look();
    if (!is_over()) give();
  }
}

}  // namespace mascot
