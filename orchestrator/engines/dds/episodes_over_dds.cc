#include "orchestrator/engines/dds/episodes_over_dds.h"

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/dds/engine.h"
#include "orchestrator/engines/dds/stepper.h"
#include "orchestrator/engines/held_actions.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/team/hearing.h"
#include "system/failure.h"
#include "system/private_folder.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

/// How often it is asked whether to wait any longer.
constexpr auto kLookEvery = std::chrono::milliseconds(50);
/// How long a run that takes no more requests may take to end: longer than its recorder waits for what is missing.
constexpr auto kEndsWithin = std::chrono::seconds(30);

}  // namespace

/// An episode: the run in its own thread, and what it has told. Its functions are for the thread that steps it, but
/// those of Stepper and RowSink.
class EpisodesOverDds::Run final : public Stepper, public RowSink {
 public:
  Run(const Experiment& experiment, const Options& options)
      : experiment_(experiment),
        options_(options),
        requests_(experiment, /*pace=*/0, /*paused=*/true),
        hearing_(experiment),
        held_(experiment),
        row_(experiment.size()),
        given_(experiment.agents.size()),
        thread_([this] { Fly(); }) {}
  ~Run() override { Finish(); }

  /// Waits until `tick` is seen, or the run is over, or `goes_on` returns false.
  void Await(std::int64_t tick, const std::function<bool()>& goes_on) {
    std::unique_lock lock(mutex_);
    const auto is_there = [&] { return is_done_ || (seen_ >= tick && tick < experiment_.ticks()); };
    while (!changed_.wait_for(lock, kLookEvery, is_there) && goes_on()) {
    }
    if (!is_done_) return;
    lock.unlock();
    TellWitness();
  }
  std::int64_t tick() const {
    const std::lock_guard lock(mutex_);
    return std::max<std::int64_t>(seen_, 0);
  }
  bool has_begun() const {
    const std::lock_guard lock(mutex_);
    return seen_ >= 0;
  }
  bool is_over() const {
    const std::lock_guard lock(mutex_);
    return is_done_;
  }

  // What is known of the tick: the run waits there, or is over.
  const Experiment& now() const { return now_ ? *now_ : experiment_; }
  const DecodedRow& row() const { return row_; }
  std::vector<int> HeardBy(int id) const {
    std::vector<int> ids;
    for (const Heard& heard : hearing_.Of(id)) ids.push_back(heard.id);
    return ids;
  }
  const std::string& failure() const { return result_.failure; }

  void Give(int id, std::span<const double> action) {
    held_.Act(id, action);
    given_[static_cast<std::size_t>(id - 1)].assign(action.begin(), action.end());
  }
  /// Throws std::invalid_argument if the run does not take it.
  void Take(const std::string& toml) {
    const Answer answer = requests_.Ask({.kind = Request::Kind::kEvent, .toml = toml});
    if (!answer.granted) throw std::invalid_argument(answer.words);
  }
  void GoTo(std::int64_t tick, const std::function<bool()>& goes_on) {
    const std::int64_t from = this->tick();
    tick = std::min(tick, experiment_.ticks());
    if (options_.witness != nullptr && !is_witnessed_) {
      sinks_ = options_.witness->Begin(experiment_);
      is_witnessed_ = true;
    }
    Open(tick);
    const Answer answer = requests_.Ask({.kind = Request::Kind::kStep, .number = static_cast<double>(tick - from)});
    if (!answer.granted) return AwaitEnd(answer.words);
    Await(tick, goes_on);
  }
  /// Ends the run at its tick, if it is not over. Returns whether the DDS library has let go.
  bool Finish() {
    if (!thread_.joinable()) return !hangs_;
    if (!is_over()) {
      Open(experiment_.ticks() + 1);
      if (!has_begun() || !requests_.Ask({.kind = Request::Kind::kStop}).granted) stop_.Raise(SIGTERM);
      Await(experiment_.ticks(), [] { return true; });
    }
    thread_.join();
    TellWitness();
    return !hangs_;
  }

  void See(std::int64_t tick, std::span<const Motion> motions, const std::vector<Event>& events,
           const std::shared_ptr<const Experiment>& now) override {
    const std::lock_guard lock(mutex_);
    std::ranges::copy(motions, row_.motions.begin());
    row_.events.clear();
    for (const Event& event : events) row_.events.push_back({++row_.events_so_far, event});
    if (!events.empty()) {
      now_ = now;
      hearing_.Adopt(now);
      held_.Adopt(*now);
    }
    hearing_.Hear(tick, row_.motions);
    seen_ = tick;
    changed_.notify_all();
  }
  bool MayGoOn(std::int64_t tick) override {
    const std::lock_guard lock(mutex_);
    return tick < open_ || tick == experiment_.ticks();
  }
  std::span<const std::vector<double>> At(std::int64_t /*tick*/) override {
    const std::lock_guard lock(mutex_);
    taken_.resize(given_.size());
    for (std::size_t i = 0; i < given_.size(); ++i) {
      taken_[i].swap(given_[i]);
      given_[i].clear();
    }
    return taken_;
  }
  void Adopt(const LiveExperiment& live, std::span<const Event> events) override {
    for (RowSink* const sink : sinks_) sink->Adopt(live, events);
  }
  void Add(const FlownRow& row) override {
    hearing_.Send(row.decoded().messages);
    for (RowSink* const sink : sinks_) sink->Add(row);
  }

 private:
  void Fly() {
    EngineResult result;
    std::optional<PrivateFolder> logs;
    std::optional<RunFolder> folder;
    std::optional<DdsEngine> engine;
    try {
      logs.emplace();
      folder.emplace((logs->path() / "run").string(), experiment_, /*force=*/false);
      engine.emplace(experiment_, *folder, std::vector<RowSink*>{&requests_, this}, &requests_, options_.console, stop_,
                     nullptr, nullptr, this);
      result = engine->Fly();
    } catch (const std::exception& failure) {
      result.failure = InWords(failure);
    }
    requests_.Close();
    {
      const std::lock_guard lock(mutex_);
      result_ = std::move(result);
      is_done_ = true;
    }
    changed_.notify_all();
    if (engine) hangs_ = !engine->End(/*process_goes_on=*/true);
  }
  /// Lets the ticks before this one go on.
  void Open(std::int64_t tick) {
    {
      const std::lock_guard lock(mutex_);
      open_ = tick;
    }
    stop_.Wake();
  }
  /// A request was refused: the run is over, or will be at once. Throws std::runtime_error with these words otherwise.
  void AwaitEnd(const std::string& words) {
    const auto deadline = std::chrono::steady_clock::now() + kEndsWithin;
    Await(experiment_.ticks(), [deadline] { return std::chrono::steady_clock::now() < deadline; });
    if (!is_over()) throw std::runtime_error(words);
  }
  void TellWitness() {
    if (std::exchange(is_witnessed_, false)) options_.witness->End(result_);
  }

  const Experiment& experiment_;
  const Options& options_;
  StopSignal stop_{StopSignal::Hears::kThreads};
  RunRequests requests_;
  std::vector<RowSink*> sinks_;  // of the witness; set before the first row is handed out
  bool is_witnessed_ = false;
  std::atomic<bool> hangs_ = false;

  mutable std::mutex mutex_;  // guards what is below
  std::condition_variable changed_;
  std::int64_t seen_ = -1;
  std::int64_t open_ = 0;                  // ticks before it may go on
  std::shared_ptr<const Experiment> now_;  // null before the first event
  Hearing hearing_;
  HeldActions held_;
  DecodedRow row_;
  std::vector<std::vector<double>> given_, taken_;  // by id - 1: for the next At(); what the last one has returned
  bool is_done_ = false;
  EngineResult result_;

  std::thread thread_;  // last: it uses all of this
};

EpisodesOverDds::EpisodesOverDds(std::string text, std::string path, std::vector<Override> overrides, Options options)
    : SteppedTeam(std::move(text), std::move(path), std::move(overrides), Keeps::kHistory),
      options_(std::move(options)) {
  Reset({});
}

EpisodesOverDds::~EpisodesOverDds() { Leave(); }

void EpisodesOverDds::Finish() {
  if (run_ == nullptr) return;
  is_stuck_ = !run_->Finish() || is_stuck_;
  run_.reset();
}

bool EpisodesOverDds::Leave() {
  try {
    Finish();
  } catch (const std::exception&) {  // nobody is there to hear of it
  }
  return !is_stuck_;
}

void EpisodesOverDds::Reset(std::vector<Override> changes) {
  Finish();
  std::shared_ptr<const Experiment> experiment = ExperimentWith(changes);
  RefuseTooManyProcesses(*experiment);
  Begin(std::move(experiment), std::move(changes));
}

void EpisodesOverDds::AwaitStates() {
  if (run_ == nullptr) run_ = std::make_unique<Run>(experiment(), options_);
  if (run_->has_begun()) return;
  run_->Await(0, options_.may_go_on);
  if (!run_->has_begun())
    throw std::runtime_error(run_->is_over() ? run_->failure() : "the server ends before the first tick");
}

const Experiment& EpisodesOverDds::now() const { return run_->now(); }
std::int64_t EpisodesOverDds::tick() const { return run_ == nullptr ? 0 : run_->tick(); }
const DecodedRow& EpisodesOverDds::row() const { return run_->row(); }
std::vector<int> EpisodesOverDds::HeardBy(int id) const { return IsLost(id) ? std::vector<int>() : run_->HeardBy(id); }
bool EpisodesOverDds::is_over() const { return run_ != nullptr && run_->is_over(); }
const std::string& EpisodesOverDds::failure() const { return run_->failure(); }
void EpisodesOverDds::Give(int id, std::span<const double> action) { run_->Give(id, action); }

void EpisodesOverDds::Take(const std::string& toml) {
  const Event event = EventByHand(toml);
  run_->Take(toml);
  Note(event.tick, toml);
}

void EpisodesOverDds::GoTo(std::int64_t tick, const std::function<bool()>& goes_on) {
  RequireGoingOn();
  run_->GoTo(tick, goes_on);
  if (is_over() && !failure().empty()) throw std::runtime_error(failure());
}

}  // namespace mascot
