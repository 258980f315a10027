#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "agent/agent.h"
#include "agent/low_level.h"
#include "base/crew.h"
#include "experiment/experiment.h"
#include "orchestrator/team/exchange.h"

namespace mascot {

/// All agents of an experiment in one process. At each tick, call Decide or Want.
class Team {
 public:
  /// `crew`: the threads that compute, unless agents fly laws of users; it must outlive the team. The bits do not
  /// depend on it.
  explicit Team(const Experiment& experiment, Crew& crew = Crew::Alone());

  /// The law of an agent has failed at a tick.
  struct Failure {
    int agent = 0;
    std::string words;  ///< with the tick
  };

  /// Call it when events have changed the experiment: from the next tick on, the experiment is `now`.
  void Adopt(const std::shared_ptr<const Experiment>& now);
  /// Lets all agents measure and hear at this tick, before Decide() or Want(), which do it otherwise. Agents that are
  /// lost do not.
  void Sense(std::int64_t tick, std::span<const Motion> motions);
  /// What somebody outside wants of agent `id` (Law::Act), from the next Decide() or Want() on.
  void Act(int id, std::span<const double> action) { agents_[static_cast<std::size_t>(id - 1)]->Act(action); }
  /// As it is after the last Sense(), or the last tick.
  const Agent& agent(int id) const { return *agents_[static_cast<std::size_t>(id - 1)]; }
  /// The complete commands of all agents, by id - 1. `motions`: their states at this tick. Messages that are sent
  /// during this tick arrive at the next one. Agents that are lost, or in `silent`, decide nothing and send nothing;
  /// their commands stay as they are. `failures` gets the agents whose laws fail, by increasing id; until the next
  /// Adopt(), they are as if in `silent`. Null: throws what Agent::Want throws, for the first that fails.
  void Decide(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands,
              std::span<const int> silent = {}, std::vector<Failure>* failures = nullptr);
  /// As Decide, but without the low-level stacks: the commands are those of Agent::Want.
  void Want(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands,
            std::vector<Failure>* failures = nullptr);
  /// Agent `id` has not answered the last tick after all, and has sent nothing: call it before the next one.
  void TakeBack(int id);
  /// Whether agent `id` has answered the last tick.
  bool HasAnswered(int id) const { return has_answered_[static_cast<std::size_t>(id - 1)] != 0; }
  /// The message that agent `id` sent last.
  std::span<const double> message(int id) const { return agents_[static_cast<std::size_t>(id - 1)]->message(); }

 private:
  /// Agents that one thread computes.
  struct Part {
    Part(const Experiment& experiment, AgentRange agents);
    AgentRange ids;
    LowLevel low_level;
    std::vector<Controller::Input> driven;
    std::vector<Sample> samples;                        // scratch
    std::vector<std::pair<std::size_t, Command>> kept;  // of agents that have not answered, by index in the part
    std::vector<Failure> failures;
  };

  bool AnyAsksCodeOfUser() const;
  template <class Work>
  void ForEachPart(Work&& work);
  void Sense(std::int64_t tick, std::span<const Motion> motions, int id, std::vector<Sample>& samples);
  void Want(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands, Part& part,
            bool failures_count);
  void CollectFailures(std::vector<Failure>* failures);
  void Actuate(std::span<Command> commands, Part& part);

  Crew& crew_;
  bool takes_turns_ = false;
  std::int64_t sensed_ = -1;        // tick of the last Sense()
  std::vector<char> has_answered_;  // by id - 1; no vector<bool>: threads write it
  std::vector<std::unique_ptr<Agent>> agents_;
  std::vector<Part> parts_;
  Exchange exchange_;
};

}  // namespace mascot
