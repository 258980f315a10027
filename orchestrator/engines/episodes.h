#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/flight.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

class Episodes;

/// Sees episodes: records them, or shows them.
class EpisodeWitness {
 public:
  virtual ~EpisodeWitness() = default;
  /// An episode leaves its tick 0. Returns the sinks that get its rows; none: it passes over this episode, without an
  /// End(). `experiment` lives until End() has returned.
  virtual std::vector<RowSink*> Begin(const Experiment& experiment) = 0;
  /// The sinks have got the row of a tick that is not the last. May wait until it is time for the next, and give events
  /// to `episodes`. Returns false if the episode is to end at this tick.
  virtual bool Await(Episodes& episodes);
  /// The episode is over. Its failure, if it has one, says why it ended early.
  virtual void End(const EngineResult& result) = 0;
};

/// Flights of one experiment, one after the other, each of which somebody steps: he sees what the agents perceive at a
/// tick, gives actions to those whose laws take them, and goes on to the next tick.
class Episodes {
 public:
  /// Whether Save() is wanted: what was given to an episode is kept for it.
  enum class Keeps { kHistory, kNothing };
  /// `text`, of the file at `path`, with `overrides`, is the experiment. The first episode is at its tick 0. Throws
  /// ConfigError, and what laws throw when they are made.
  Episodes(std::string text, std::string path, std::vector<Override> overrides, Keeps keeps = Keeps::kHistory);
  ~Episodes();
  Episodes(const Episodes&) = delete;
  Episodes& operator=(const Episodes&) = delete;

  /// From the next episode that leaves its tick 0 on, `witnesses` see the episodes. They must live as long as they are
  /// asked, and until the End() of the last one.
  void SetWitnesses(std::vector<EpisodeWitness*> witnesses) { next_witnesses_ = std::move(witnesses); }

  /// Ends the episode, and begins one of the experiment with `changes` beside the overrides. It is read again only if
  /// they differ from those before. Throws as the constructor does; then the episode before has ended, and stays.
  void Reset(std::vector<Override> changes);
  /// The experiment of this episode, as it began. Lives until the next Reset().
  const Experiment& experiment() const { return *experiment_; }
  /// As events up to this tick have changed it.
  const Experiment& now() const { return flight_->now(); }
  std::int64_t tick() const { return flight_->tick(); }
  /// The states of this tick, and its events.
  const DecodedRow& row() const { return *row_; }
  /// Agent `id`, which has measured and heard what is to be known at this tick, unless it is lost.
  const Agent& agent(int id) const { return flight_->agent(id); }
  /// The pace that an event of this tick has set; nullopt: none has.
  std::optional<double> new_pace() const { return flight_->new_pace(); }
  /// Whether the episode is over: this is its last tick, it cannot go on, or a witness has ended it.
  bool is_over() const { return is_over_; }
  /// Why the episode cannot go on, in words; empty: it can, or it ended in order.
  const std::string& failure() const { return result_.failure; }

  /// What agent `id` is to do from this tick on, as Flight::Act() takes it. Throws std::invalid_argument, also if there
  /// is no such agent.
  void Act(int id, std::span<const double> action);
  /// An event by hand at the next tick: the keys of [[events]] but at_s, as TOML ("set = {...}"). Throws ConfigError or
  /// std::invalid_argument, and changes nothing, if it is not legal, or if the episode is over.
  void Take(const std::string& toml);
  void Take(Event event);
  /// Goes on to the next tick, if no witness ends the episode at this one. If an agent is lost and that ends the run,
  /// the episode is over. Throws std::runtime_error if a law fails, which ends the episode, too, or if the episode is
  /// over already.
  void Step();
  /// Ends the episode at this tick, if it is not over. Witnesses get what its agents answer, or why a law fails. Throws
  /// what they throw.
  void Finish();

  /// An episode so far: flying again all that was given to it leads to the same tick, and to the same bits.
  struct Snapshot {
    struct Given {
      std::int64_t tick = 0;
      int agent = 0;
      std::size_t numbers = 0;  ///< how many of the action
    };
    struct GivenEvent {
      std::int64_t tick = 0;  ///< at which it took effect
      std::string toml;       ///< as Take() gets it
    };
    std::uint64_t of = 0;  ///< stands for the experiment and its overrides: it fits no other
    std::vector<Override> changes = {};
    std::int64_t tick = 0;
    std::vector<Given> given = {};     ///< the actions, in the order in which they were given
    std::vector<double> actions = {};  ///< their numbers, one action after the other
    std::vector<GivenEvent> events = {};
  };
  /// Throws std::logic_error if no history is kept.
  Snapshot Save() const;
  /// Ends the episode, and flies that of the snapshot up to its tick. `look` is called at each tick. Throws
  /// std::invalid_argument, and changes nothing, if the snapshot is of another experiment; and what Reset(), Step() and
  /// `look` throw.
  void Restore(const Snapshot& snapshot, const std::function<void()>& look);
  /// Whether Restore() is flying: then nobody is to wait.
  bool is_restoring() const { return tick() < restored_to_; }

 private:
  Experiment Load(std::span<const Override> changes) const;
  void Sense();
  void AskWitnesses();
  /// Lets the witnesses wait. Returns whether the episode goes on.
  bool Await();
  /// Lets the agents answer this tick, and hands the row to the witnesses.
  void Answer();
  void End();

  const std::string text_, path_;
  std::vector<Override> overrides_;
  std::uint64_t identity_ = 0;  // Snapshot::of
  const Keeps keeps_;
  std::vector<EpisodeWitness*> next_witnesses_;
  std::vector<EpisodeWitness*> witnesses_;        // of this episode
  std::shared_ptr<const Experiment> experiment_;  // shared while Reset() makes the next flight
  std::unique_ptr<Flight> flight_;
  std::optional<RowFeed> feed_;  // to the witnesses
  const DecodedRow* row_ = nullptr;
  bool is_over_ = false;
  std::int64_t restored_to_ = 0;  // the tick of Restore()
  EngineResult result_;
  std::chrono::steady_clock::time_point began_;
  Snapshot history_;
};

}  // namespace mascot
