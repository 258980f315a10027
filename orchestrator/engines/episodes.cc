#include "orchestrator/engines/episodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "orchestrator/engines/inprocess.h"

namespace mascot {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

bool EpisodeWitness::Await(Episodes& /*episodes*/) { return true; }

Episodes::Episodes(std::string text, std::string path, std::vector<Override> overrides, Keeps keeps)
    : SteppedTeam(std::move(text), std::move(path), std::move(overrides), keeps) {
  Reset({});
}

Episodes::~Episodes() { Leave(); }

bool Episodes::Leave() {
  try {
    Finish();
  } catch (const std::exception&) {  // nobody is there to hear of it
  }
  return true;
}

void Episodes::Reset(std::vector<Override> changes) {
  Finish();
  const auto launched = Clock::now();
  std::shared_ptr<const Experiment> experiment = ExperimentWith(changes);
  flight_ = std::make_unique<Flight>(*experiment);
  Begin(std::move(experiment), std::move(changes));
  began_ = Clock::now();
  result_ = {};
  result_.startup_s = std::chrono::duration<double>(began_ - launched).count();
  is_over_ = false;
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
    const std::vector<RowSink*> its_sinks = witness->Begin(experiment());
    if (its_sinks.empty()) continue;
    witnesses_.push_back(witness);
    sinks.insert(sinks.end(), its_sinks.begin(), its_sinks.end());
  }
  if (!sinks.empty()) feed_.emplace(experiment(), sinks);
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
  result_.unanswered = flight_->unanswered();
  for (EpisodeWitness* const witness : std::exchange(witnesses_, {})) witness->End(result_);
}

std::vector<int> Episodes::HeardBy(int id) const {
  std::vector<int> ids;
  if (IsLost(id)) return ids;
  for (const Heard& heard : agent(id).heard()) ids.push_back(heard.id);
  return ids;
}

void Episodes::Take(Event event) {
  event.tick = tick() + 1;
  LiveExperiment live = flight_->Ahead();
  live.CheckAll();
  live.Take(event);
  Note(event.tick, event.Toml());
  flight_->Take(std::move(event));
}

void Episodes::Step() {
  RequireGoingOn();
  Answer();
  if (!Await()) return End();
  flight_->Step();
  Sense();
  if (is_over_ || tick() < experiment().ticks()) return;
  Answer();
  End();
}

void Episodes::GoTo(std::int64_t tick, const std::function<bool()>& goes_on) {
  RequireGoingOn();
  while (this->tick() < tick && !is_over() && goes_on()) Step();
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

}  // namespace mascot
