#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mascot {

/// Says at each tick what agents do whose laws take actions (LawParams::action).
class ActionSource {
 public:
  virtual ~ActionSource() = default;
  /// Over DDS: the domain of the run, and the address of the interface on which its processes are; empty: all. Called
  /// once, before the first At().
  virtual void OnDomain(int /*domain*/, const std::string& /*address*/) {}
  /// The actions of `tick`, by id - 1; empty: the agent gets none, so that the action before holds. Asked once at each
  /// tick, in order, when the states of that tick are known and, in lockstep, the rows of all ticks before are with the
  /// sinks; in the thread that gives them these. Valid until the next call. Throws std::runtime_error, which ends the
  /// run, if there are none for this tick. Over DDS, who answers later than run.agent_timeout_s keeps agents from
  /// answering in time.
  virtual std::span<const std::vector<double>> At(std::int64_t tick) = 0;
};

/// Calls act(id, action) for each agent that `source` gives an action at `tick`.
template <class Act>
void ForEachAction(ActionSource& source, std::int64_t tick, const Act& act) {
  const std::span<const std::vector<double>> actions = source.At(tick);
  for (std::size_t i = 0; i < actions.size(); ++i)
    if (!actions[i].empty()) act(static_cast<int>(i) + 1, actions[i]);
}

}  // namespace mascot
