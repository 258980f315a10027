#include "orchestrator/engines/episodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "agent/laws/laws.h"
#include "base/fnv.h"
#include "experiment/live_experiment.h"
#include "orchestrator/engines/inprocess.h"

namespace mascot {
namespace {

using Clock = std::chrono::steady_clock;

bool AreEqual(std::span<const Override> some, std::span<const Override> others) {
  return std::ranges::equal(some, others, [](const Override& one, const Override& other) {
    return one.key == other.key && one.value == other.value && one.removes == other.removes;
  });
}

}  // namespace

bool EpisodeWitness::Await(Episodes& /*episodes*/) { return true; }

Episodes::Episodes(std::string text, std::string path, std::vector<Override> overrides, Keeps keeps)
    : text_(std::move(text)), path_(std::move(path)), overrides_(std::move(overrides)), keeps_(keeps) {
  std::string all = text_;
  for (const Override& override : overrides_) all += '\n' + override.key + " = " + override.value;
  identity_ = Fnv1a(all);
  Reset({});
}

Episodes::~Episodes() {
  try {
    Finish();
  } catch (const std::exception&) {  // nobody is there to hear of it
  }
}

Experiment Episodes::Load(std::span<const Override> changes) const {
  std::vector<Override> all = overrides_;
  all.insert(all.end(), changes.begin(), changes.end());
  Experiment experiment = LoadExperiment(text_, path_, all);
  RefuseInProcess(experiment, path_);
  return experiment;
}

void Episodes::Reset(std::vector<Override> changes) {
  Finish();
  const auto launched = Clock::now();
  std::shared_ptr<const Experiment> experiment = experiment_;
  if (experiment == nullptr || !AreEqual(changes, history_.changes))
    experiment = std::make_shared<const Experiment>(Load(changes));
  flight_ = std::make_unique<Flight>(*experiment);
  experiment_ = std::move(experiment);
  history_ = {.changes = std::move(changes)};
  began_ = Clock::now();
  result_ = {};
  result_.startup_s = std::chrono::duration<double>(began_ - launched).count();
  is_over_ = false;
  restored_to_ = 0;
  Sense();
}

void Episodes::Sense() {
  try {
    row_ = &flight_->Sense();
  } catch (const LossEndsRun& loss) {
    row_ = &flight_->row();
    result_.failure = loss.what();
    End();
  }
}

void Episodes::AskWitnesses() {
  std::vector<RowSink*> sinks;
  for (EpisodeWitness* const witness : next_witnesses_) {
    const std::vector<RowSink*> its_sinks = witness->Begin(*experiment_);
    if (its_sinks.empty()) continue;
    witnesses_.push_back(witness);
    sinks.insert(sinks.end(), its_sinks.begin(), its_sinks.end());
  }
  if (!sinks.empty()) feed_.emplace(*experiment_, sinks);
}

bool Episodes::Await() {
  return std::ranges::all_of(witnesses_, [this](EpisodeWitness* witness) { return witness->Await(*this); });
}

void Episodes::Answer() try {
  if (flight_->tick() == 0) AskWitnesses();
  const DecodedRow& row = flight_->Exchange();
  if (feed_) feed_->Add(flight_->tick(), row);
} catch (const std::exception& failure) {
  result_.failure = failure.what();
  End();
  throw;
}

void Episodes::End() {
  is_over_ = true;
  feed_.reset();
  if (witnesses_.empty()) return;
  result_.wall_s = std::chrono::duration<double>(Clock::now() - began_).count();
  result_.contacts = flight_->contacts();
  for (EpisodeWitness* const witness : std::exchange(witnesses_, {})) witness->End(result_);
}

void Episodes::Act(int id, std::span<const double> action) {
  if (id < 1 || id > experiment_->size())
    throw std::invalid_argument(fmt::format("expected an agent from 1 to {}, got {}", experiment_->size(), id));
  flight_->Act(id, action);
  if (keeps_ == Keeps::kNothing) return;
  history_.given.push_back({.tick = tick(), .agent = id, .numbers = action.size()});
  history_.actions.insert(history_.actions.end(), action.begin(), action.end());
}

void Episodes::Take(const std::string& toml) {
  constexpr const char* kByHand = "event by hand";
  if (is_over_) throw std::invalid_argument(std::string(kByHand) + ": the episode is over");
  const Event event = EventFrom(tick() + 1, toml, experiment_->size(), kByHand);
  if (StandsElsewhere(toml))
    throw std::invalid_argument(std::string(kByHand) + ": expected keys of [[events]], got what no file has there");
  Take(event);
}

void Episodes::Take(Event event) {
  event.tick = tick() + 1;
  LiveExperiment live = flight_->Ahead();
  live.CheckAll();
  live.Take(event);
  if (keeps_ == Keeps::kHistory) history_.events.push_back({event.tick, event.Toml()});
  flight_->Take(std::move(event));
}

void Episodes::Step() {
  if (is_over_) throw std::runtime_error("the episode is over: expected a reset");
  Answer();
  if (!Await()) return End();
  flight_->Step();
  Sense();
  if (is_over_ || tick() < experiment_->ticks()) return;
  Answer();
  End();
}

void Episodes::Finish() {
  if (flight_ == nullptr || is_over_) return;
  if (witnesses_.empty()) return End();
  try {
    Answer();
    End();
  } catch (const std::exception&) {
    if (result_.failure.empty()) throw;  // else a law has failed: the witness knows, and nobody flies on
  }
}

Episodes::Snapshot Episodes::Save() const {
  if (keeps_ == Keeps::kNothing) throw std::logic_error("a snapshot of episodes without a history");
  Snapshot snapshot = history_;
  snapshot.of = identity_;
  snapshot.tick = tick();
  return snapshot;
}

void Episodes::Restore(const Snapshot& snapshot, const std::function<void()>& look) {
  if (snapshot.of != identity_)
    throw std::invalid_argument("expected a snapshot of the same file, with the same keys set, got one of another");
  Reset(snapshot.changes);
  restored_to_ = snapshot.tick;
  look();
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
  give();
  while (tick() < snapshot.tick) {
    Step();
    look();
    if (!is_over_) give();
  }
}

}  // namespace mascot
