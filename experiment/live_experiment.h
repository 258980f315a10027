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
#include "experiment/live_laws.h"
#include "experiment/live_tables.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/value_tables.h"

namespace mascot {

/// An experiment while it flies: what its file says, changed by the events so far. An event puts its values into the
/// tables that it names, and these alone are read again, by the readers and rows of the file: so values are checked,
/// and refused, in the same way, and a gain costs what the reader of its law does, however long the file is.
class LiveExperiment {
 public:
  static constexpr int kMaxEvents = 100000;  ///< of a file, and of a run with those by hand, whose file holds them all
  static constexpr std::size_t kMaxEventBytes = std::size_t{1} << 20;  ///< of Event::Toml()

  /// `laws` null: the parameters of laws are neither read nor checked (the physics server). `checked`: the events were
  /// taken before without a mistake: slow checks, which run the code of a law, are left out. `laws` must outlive this.
  LiveExperiment(const Experiment& start, const LawCatalog* laws, bool checked);

  /// From now on every check of an experiment file is made.
  void CheckAll() { now_.checked = false; }
  /// Takes the next event. Throws ConfigError, with event.where in front, and changes nothing, if it names a key that
  /// is not live, a value that is not legal, an edge that the file does not declare, or an agent that flies no
  /// waypoints, or is larger than kMaxEventBytes.
  void Take(const Event& event);
  /// The experiment as it is now; null before the first event. Const and shared: code that flies by it keeps it as long
  /// as needed. It is made when it is first asked for after an event, in the thread that asks. Its `resolved` and
  /// `events` are empty: ValueOf() knows its values.
  const std::shared_ptr<const Experiment>& now() const;
  /// The same before the first event, too; it changes with the next.
  const Experiment& current() const { return now_; }
  /// The experiment after the next event.
  const std::shared_ptr<const Experiment>& After(const Event& event) {
    Take(event);
    return now();
  }
  /// The value of a live key now, dotted: the team's; nullopt: the experiment has none.
  std::optional<Value> ValueOf(const std::string& key) const { return tables_.Get(key); }
  /// The values of a live key that agents have of their own now, by the file or by events, by id; at most `most`.
  std::map<int, Value> OwnValuesOf(const std::string& key, std::size_t most) const;
  /// The events that run.on_agent_loss = "restart" brings at `tick`, after those of the file and those by hand. They
  /// must be taken, too; they stand in no file.
  std::vector<Event> RestartsAt(std::int64_t tick) const;
  /// The tick of the next of these events, as far as the events so far bring any; nullopt: none is to come.
  std::optional<std::int64_t> NextRestart() const;
  /// How many events were taken so far.
  int count() const { return count_; }

 private:
  /// An agent's own table in the document, agents.override[k], but for its values.
  struct Own {
    int id = 0;
    bool has_law = false;  ///< it has a law table in the file, which a phase of the team's does not concern
    /// Dotted keys that events have set for this agent, and the tables that it has because of that.
    std::vector<std::string> set = {};
  };

  /// Whether an event for all that sets `key` concerns the own value of agents.override[k]: it has the key, or an
  /// earlier event has set for it a key inside `key` or around it.
  bool IsReached(std::size_t k, const std::string& key) const;
  /// Puts what the event says into the tables.
  TouchedTables Put(const Event& event);
  void PutLaw(const Event& phase, TouchedTables& touched);
  void Set(const Event& event, const std::string& key, const Value& value, TouchedTables& touched);
  void SetFor(int agent, const std::string& where, const std::string& key, const Value& value, TouchedTables& touched);
  /// The index of an agent's own table, which begins if there is none.
  std::size_t OverrideIndex(int agent, const std::string& where);
  /// The table whose keys the user chooses that an agent takes over from the team when the dotted `key` inside it is
  /// set for this agent alone, and what stands in it now; none: `key` is in no such table, or the agent has its own.
  std::optional<std::pair<std::string, Value>> TakenOver(std::size_t k, const std::string& key) const;
  std::vector<int> Owners() const;
  /// The agents whose own law tables inherit nothing: those of the file, once a phase has changed the team's.
  std::set<int> WithTheirOwnLaw() const;
  /// Notes of which agents the law begins anew with a phase.
  void BeginLaws(const Event& phase);
  void CheckKey(const Event& event, const std::string& key) const;
  /// Checks that the laws of the agents that the event concerns let their law.params change. `laws`: with the event.
  void CheckParams(const Event& event, const LawsAgain& laws) const;
  /// Notes what a fault or a restart does to its agent.
  void TakeFault(const Event& event);
  /// nullopt: the event changes no edges.
  std::optional<std::set<std::pair<int, int>>> CutAfter(const Event& event) const;

  const LawCatalog* laws_;
  Experiment now_;
  mutable std::shared_ptr<const Experiment> shared_;  // a copy of now_; null: not asked for since the last event
  ValueTables tables_;
  std::vector<Own> own_;                                           // by index in agents.override
  std::vector<std::size_t> places_;                                // in own_, by id - 1; of agents without: any
  std::map<int, std::shared_ptr<const Value::Table>> law_tables_;  // of agents with their own, by id; at 0 the team's;
                                                                   // as the file has them, but for live keys
  bool team_has_changed_ = false;                                  // by a phase
  std::set<std::pair<std::int64_t, int>> restarts_;                // that run.on_agent_loss will bring: ticks and ids
  std::int64_t phase_tick_ = -1;  // at which the newest phase began; -1: there is only the first
  int count_ = 0;                 // of events
};

}  // namespace mascot
