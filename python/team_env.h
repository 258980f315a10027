#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agent/laws/parts/observation.h"
#include "base/random.h"
#include "orchestrator/engines/episodes.h"
#include "orchestrator/live/shown/episode_view.h"
#include "orchestrator/report/episode_record.h"

namespace mascot {

/// A team as an environment for learning: the agents that take actions, what they observe, and how the whole team is.
/// All episodes have the agents, layout and bounds of the first, which depend on no seed. Its own methods are called by
/// one thread at a time. Numbers are doubles; vectors are in W, in SI units.
class TeamEnv {
 public:
  /// As Episodes. If no agent of the file takes actions, all agents do that have no law of their own. Throws
  /// ConfigError, also if nobody takes actions.
  TeamEnv(const std::string& text, const std::string& path, std::vector<Override> overrides,
          Episodes::Keeps keeps = Episodes::Keeps::kHistory);

  /// The agents that take actions, by increasing id: the others fly by laws of their own.
  const std::vector<int>& agents() const { return ids_; }
  const ObservationLayout& layout() const { return layout_; }
  /// How many numbers the action of the k-th agent has; those that have most have action_size().
  std::size_t action_size(std::size_t k) const { return high_[k].size(); }
  std::size_t action_size() const { return action_size_; }
  /// The largest of each number of the k-th agent's action that the agent's limits leave as it is, or 1 for a number of
  /// a message. The smallest is its negative.
  const std::vector<double>& action_high(std::size_t k) const { return high_[k]; }
  /// What no observation exceeds, number by number, nor falls below the negative of: derived from places, limits and
  /// duration; 1e6 for weights; infinity where neither the file nor physics gives a bound: messages, and what agents
  /// say that lie, or measure with broken sensors.
  const std::vector<double>& observation_high() const { return observation_high_; }
  const Experiment& experiment() const { return episodes_.experiment(); }
  const Episodes& episodes() const { return episodes_; }

  /// Begins an episode. `seed`: its run.seed, from which those of the next episodes without a seed follow; nullopt: it
  /// follows from that before, and is the file's in the first episode. `sets`: beside the overrides, in this and the
  /// next episodes; nullopt: as before. Throws what Episodes::Reset() throws, and ConfigError if the experiment has
  /// other agents, actions or layouts than before.
  void Reset(std::optional<std::uint64_t> seed, std::optional<std::vector<Override>> sets);
  /// The seed of this episode.
  std::uint64_t seed() const { return experiment().run.seed; }
  /// Goes on to the next tick. `actions`: agents() rows of action_size() numbers, of which an agent takes the first
  /// action_size(k); `given[k]`: whether the k-th agent has a new one; else its earlier one holds, 0 at first. Throws
  /// what Episodes::Act() and Step() throw.
  void Step(std::span<const double> actions, std::span<const char> given);
  /// Goes on to the next tick, and leaves the actions as they are, or as Act() has set them.
  void Step();
  /// What agent `id` is to do from this tick on.
  void Act(int id, std::span<const double> action) { episodes_.Act(id, action); }
  void Take(const std::string& event) { episodes_.Take(event); }

  /// What the agents observe at this tick: agents() rows of layout().size(). The row of an agent that is lost is the
  /// last before that.
  std::span<const double> observations() const { return observations_; }
  /// Writes the true state of each agent of the team, kStateNumbers each (base/state_numbers.h), by id - 1.
  void StateTo(std::span<double> to) const;
  /// How far the team is from agreement (m), as the runs' figures have it (DisagreementOf).
  double disagreement_m() const;
  /// Whether the k-th agent is lost, or was in this episode: no agent comes back.
  bool is_lost(std::size_t k) const { return is_lost_[k] != 0; }
  /// Whether the episode ended in order: at the last tick of run.duration_s, or where a viewer has stopped it.
  bool is_at_end() const { return episodes_.is_over() && episodes_.failure().empty(); }
  bool is_over() const { return episodes_.is_over(); }
  /// Why the episode ended before its time; empty: it has not.
  const std::string& failure() const { return episodes_.failure(); }

  /// Records the next episode that leaves its tick 0, this one if it has not, in the folder `out` (RunFolder), which it
  /// returns. Throws ConfigError.
  std::string Record(const std::optional<std::string>& out, bool force, const RunFolder::Words& words);
  /// Shows this episode, if it has not left its tick 0, and the next ones on a page; returns its address. While viewers
  /// pause an episode, Step() waits. Throws ConfigError, also if there is a page already.
  std::string View(const EpisodeView::Options& options);
  /// Ends the episode at this tick, so that its recording is complete.
  void Finish() { episodes_.Finish(); }
  /// Finish(), and ends the page.
  void Close();
  Episodes::Snapshot Save() const { return episodes_.Save(); }
  /// Throws what Reset() throws.
  void Restore(const Episodes::Snapshot& snapshot);

 private:
  /// Prepares for an episode that has just begun. Throws ConfigError if it does not fit the first.
  void Begin();
  /// Takes in how the team is at this tick.
  void Look();

  void TellWitnesses();

  std::unique_ptr<EpisodeRecord> record_;
  std::unique_ptr<EpisodeView> view_;
  Episodes episodes_;
  std::size_t agents_of_team_ = 0;
  std::vector<int> ids_;
  ObservationLayout layout_;
  std::size_t action_size_ = 0;
  std::vector<std::vector<double>> high_;  // by index in ids_
  std::vector<double> observation_high_;
  std::vector<Override> sets_;
  std::optional<Random> seeds_;      // of the episodes to come; absent before the first Reset()
  std::vector<Observer> observers_;  // by index in ids_
  std::vector<double> observations_;
  std::vector<char> is_lost_;
};

}  // namespace mascot
