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
  /// `laws` null: the parameters of laws are neither read nor checked (the physics server). `checked`: the events were
  /// taken before without a mistake: slow checks, which run the code of a law, are left out. Both must outlive this.
  LiveExperiment(const Experiment& start, const LawCatalog* laws, bool checked);

  /// From now on every check of an experiment file is made.
  void CheckAll() { checked_ = false; }
  /// The event of this tick that Event::Toml() is `toml` of. Throws ConfigError for other text.
  Event Parse(std::int64_t tick, const std::string& toml, const std::string& where) const;
  /// Takes the next event. Throws ConfigError, with event.where in front, and changes nothing, if it names a key that
  /// is not live, a value that is not legal, an edge that the file does not declare, or an agent that flies no
  /// waypoints.
  std::shared_ptr<const Experiment> Take(const Event& event);
  /// Takes event `number` of a run, as its recording or /event has it: of this tick, with this Event::Toml(). Throws as
  /// Parse() and Take() do, with "event NUMBER" in front.
  std::shared_ptr<const Experiment> Take(std::int64_t tick, int number, const std::string& toml) {
    return Take(Parse(tick, toml, "event " + std::to_string(number)));
  }
  /// The experiment as it is now; null before the first event.
  const std::shared_ptr<const Experiment>& now() const { return now_; }
  /// The events taken so far.
  const std::vector<Event>& events() const { return events_; }

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
  std::optional<std::pair<std::string, Value>> TakenOver(const Own& own, const std::string& key) const;
  void CheckKey(const Event& event, const std::string& key) const;
  /// Checks that the laws of those whom it concerns let their law.params change. `next`: with the event.
  void CheckParams(const Event& event, const Experiment& next) const;
  std::set<std::pair<int, int>> CutAfter(const Event& event) const;
  const Experiment& current() const { return now_ ? *now_ : start_; }

  const Experiment& start_;
  const LawCatalog* laws_;
  bool checked_;
  std::string text_;  // the resolved experiment
  std::vector<Own> own_;
  std::map<int, Value::Table> law_tables_;  // of agents with their own, by id; at 0 the team's; but for live keys
  std::vector<std::int64_t> since_;         // LawConfig::since, by id - 1
  bool team_has_changed_ = false;           // by a phase
  std::int64_t phase_tick_ = -1;            // at which the newest phase began; -1: there is only the first
  std::vector<Override> changes_;           // of all events so far
  std::vector<Event> events_;
  std::shared_ptr<const Experiment> now_;
};

}  // namespace mascot
