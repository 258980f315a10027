#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "experiment/events.h"
#include "experiment/experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Flights of one experiment, one after the other, each of which somebody steps: he sees the states of a tick, gives
/// actions to the agents whose laws take them, and goes on. An engine derives from it. What was given to an episode is
/// kept, so that the episode can be flown again.
class SteppedTeam {
 public:
  /// Whether Save() is wanted: what was given to an episode is kept for it.
  enum class Keeps { kHistory, kNothing };

  virtual ~SteppedTeam() = default;
  SteppedTeam(const SteppedTeam&) = delete;
  SteppedTeam& operator=(const SteppedTeam&) = delete;

  /// Ends the episode, and begins one of the experiment with `changes` beside the overrides. It is read again only if
  /// they differ from those before. Throws ConfigError, and what laws throw when they are made; then the episode before
  /// has ended, and stays.
  virtual void Reset(std::vector<Override> changes) = 0;
  /// Returns when the states of tick() are known; it may take its time at the first tick. Throws std::runtime_error
  /// if the episode cannot begin.
  virtual void AwaitStates() = 0;
  /// The experiment of this episode, as it began. Lives until the next Reset().
  const Experiment& experiment() const { return *experiment_; }
  virtual std::int64_t tick() const = 0;

  // Call these after AwaitStates().

  /// The experiment as events up to this tick have changed it.
  virtual const Experiment& now() const = 0;
  /// The states of this tick, and its events.
  virtual const DecodedRow& row() const = 0;
  /// Whether agent `id` is lost at this tick.
  bool IsLost(int id) const { return now().agent(id).faults.is_lost(); }
  /// The agents from which agent `id` has heard by this tick, in increasing order; none if it is lost.
  virtual std::vector<int> HeardBy(int id) const = 0;
  /// Whether the episode is over: this is its last tick, it cannot go on, or somebody else has ended it.
  virtual bool is_over() const = 0;
  /// Why the episode cannot go on, in words; empty: it can, or it ended in order.
  virtual const std::string& failure() const = 0;

  /// What agent `id` is to do from this tick on (Law::Act); it holds until the next one, and is 0 at first. Throws
  /// std::invalid_argument if there is no such agent, or its law takes no action, or none of this size.
  void Act(int id, std::span<const double> action);
  /// An event by hand at the next tick: the keys of [[events]] but at_s, as TOML ("set = {...}"). Throws ConfigError or
  /// std::invalid_argument, and changes nothing, if it is not legal, or if the episode is over.
  virtual void Take(const std::string& toml) = 0;
  /// Goes on to `tick`, which is a later one, or until the episode is over, or `goes_on`, which is asked again and
  /// again, returns false. If an agent is lost and that ends the run, the episode is over. Throws std::runtime_error if
  /// a law fails, which ends the episode, too, or if the episode is over already.
  virtual void GoTo(std::int64_t tick, const std::function<bool()>& goes_on) = 0;

  /// Ends the episode, for good. Returns whether all of it has ended; if not, the process has to end by force
  /// (LeaveNow()).
  virtual bool Leave() = 0;

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
  /// Ends the episode, and flies that of the snapshot up to its tick. `look`, if it is not empty, is called at each
  /// tick. Throws std::invalid_argument, and changes nothing, if the snapshot is of another experiment; and what
  /// Reset(), GoTo() and `look` throw.
  void Restore(const Snapshot& snapshot, const std::function<void()>& look);
  /// Whether Restore() is flying: then nobody is to wait.
  bool is_restoring() const { return tick() < restored_to_; }

 protected:
  /// `text`, of the file at `path`, with `overrides`, is the experiment.
  SteppedTeam(std::string text, std::string path, std::vector<Override> overrides, Keeps keeps);

  /// The experiment with `changes`: that of this episode, if they are the same. Throws ConfigError.
  std::shared_ptr<const Experiment> ExperimentWith(std::span<const Override> changes) const;
  /// An episode of this experiment, which has been read with `changes`, begins.
  void Begin(std::shared_ptr<const Experiment> experiment, std::vector<Override> changes);
  /// The event that Take() gets, at the next tick. Throws ConfigError or std::invalid_argument.
  Event EventByHand(const std::string& toml) const;
  /// Act(), of an agent that there is.
  virtual void Give(int id, std::span<const double> action) = 0;
  /// Throws std::runtime_error if the episode is over.
  void RequireGoingOn() const;
  /// An event was given, and will take effect at `tick`.
  void Note(std::int64_t tick, std::string toml);

 private:
  const std::string text_, path_;
  const std::vector<Override> overrides_;
  std::uint64_t identity_ = 0;  // Snapshot::of
  const Keeps keeps_;
  std::shared_ptr<const Experiment> experiment_;  // shared while Reset() makes the next flight
  std::int64_t restored_to_ = 0;                  // the tick of Restore()
  Snapshot history_;
};

}  // namespace mascot
