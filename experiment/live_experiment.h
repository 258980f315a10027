#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "experiment/events.h"
#include "experiment/experiment.h"
#include "experiment/read_experiment.h"

namespace mascot {

/// An experiment while it flies: what its file says, changed by the events so far. What an event sets is read by the
/// same rows as the file, so that it is checked, and refused, in the same way. Each state is an Experiment of its own,
/// const and shared: whoever flies by one keeps it as long as needed.
class LiveExperiment {
 public:
  static constexpr int kMostEvents = 100000;  ///< of a file, and of a run with those by hand, whose file holds them all

  /// `laws` null: the parameters of laws are neither read nor checked (the physics server). `checked`: the events were
  /// taken before without a mistake: slow checks, which run the code of a law, are left out. Both must outlive this.
  LiveExperiment(const Experiment& start, const LawCatalog* laws, bool checked);

  /// From now on every check of an experiment file is made.
  void CheckAll() { checked_ = false; }
  /// The event of this tick that Event::Toml() is `toml` of. Throws ConfigError for other text.
  Event Parse(std::int64_t tick, const std::string& toml, const std::string& where) const;
  /// Event `number` of a run, as its recording or /event has it. Throws as above, with "event NUMBER" in front.
  Event Parse(std::int64_t tick, int number, const std::string& toml) const {
    return Parse(tick, toml, "event " + std::to_string(number));
  }
  /// Takes the next event. Throws ConfigError, with event.where in front, and changes nothing, if it names a key that
  /// is not live, a value that is not legal, an edge that the file does not declare, or an agent that flies no
  /// waypoints.
  std::shared_ptr<const Experiment> Take(const Event& event);
  /// Parses and takes an event of a run.
  std::shared_ptr<const Experiment> Take(std::int64_t tick, int number, const std::string& toml) {
    return Take(Parse(tick, number, toml));
  }
  /// The experiment as it is now; null before the first event.
  const std::shared_ptr<const Experiment>& now() const { return now_; }
  /// How many events were taken so far.
  int count() const { return count_; }

 private:
  /// An agent's own table in the document, and the keys that stand in it: those of the file and those that events have
  /// set for this agent.
  struct Own {
    int id = 0;
    std::vector<std::string> keys;  ///< dotted: "law.p_gain"
    /// Those that events have set for this agent, and the tables that it has because of that.
    std::vector<std::string> set = {};
    bool has_law = false;  ///< it has a law table of its own, which a phase of the team's does not concern

    /// Whether an event for all that sets `key` concerns this agent's own value of it: the agent has the key, or an
    /// earlier event has set for it a key inside `key` or around it.
    bool IsReachedBy(const std::string& key) const;
  };

  /// Reads the whole experiment with these changes. `where`: the place of the event that makes the last of them.
  Experiment Read(std::vector<Override>& changes, const std::string& where) const;
  std::vector<Override> Changes(const Event& event);
  /// The agents whose own law tables inherit nothing: those of the file, once a phase has changed the team's.
  std::set<int> WithTheirOwnLaw() const;
  /// Takes out of `changes` what they set in the law tables that a phase replaces.
  void ForgetLaws(const Event& phase, std::vector<Override>& changes);
  /// Notes of which agents the law begins anew with a phase.
  void BeginLaws(const Event& phase);
  void Set(const Event& event, const std::string& key, const Value& value, std::vector<Override>& changes);
  /// The index of an agent's own table, which `changes` begins if there is none.
  std::size_t OwnOf(int agent, const std::string& where, std::vector<Override>& changes);
  void SetFor(int agent, const std::string& where, const std::string& key, const Value& value,
              std::vector<Override>& changes);
  /// The table whose keys the user chooses that an agent takes over from the team when the dotted `key` inside it is
  /// set for this agent alone, and what stands in it now; none: `key` is in no such table, or the agent has its own.
  std::optional<std::pair<std::string, Value>> TakenOver(const Own& own, const std::string& key);
  void CheckKey(const Event& event, const std::string& key) const;
  /// Checks that the laws of those whom it concerns let their law.params change. `next`: with the event.
  void CheckParams(const Event& event, const Experiment& next) const;
  std::set<std::pair<int, int>> CutAfter(const Event& event) const;
  const Experiment& current() const { return now_ ? *now_ : start_; }

  const Experiment& start_;
  const LawCatalog* laws_;
  bool checked_;
  std::string text_;  // the resolved experiment, without events
  std::vector<Own> own_;
  std::vector<std::size_t> places_;                        // in own_, by id - 1; of agents without their own: any
  std::optional<std::map<int, Value::Table>> tables_now_;  // LawTablesOf() the newest; empty: not asked for yet
  std::map<int, Value::Table> law_tables_;  // of agents with their own, by id; at 0 the team's; but for live keys
  std::vector<std::int64_t> since_;         // LawConfig::since, by id - 1
  bool team_has_changed_ = false;           // by a phase
  std::int64_t phase_tick_ = -1;            // at which the newest phase began; -1: there is only the first
  std::vector<Override> changes_;           // of all events so far
  int count_ = 0;                           // of events
  std::shared_ptr<const Experiment> now_;
};

}  // namespace mascot
