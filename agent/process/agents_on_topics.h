#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "agent/process/agent_runner.h"
#include "agent/process/agents_on_wire.h"

namespace mascot {

/// network.delivery = "topics": the process has one reader for the states, and one for the messages, of each agent that
/// its own agents may hear, and each agent writes its own commands and messages.
class AgentsOnTopics final : public AgentsOnWire {
 public:
  /// `on_first_answer` is called when an agent answers for the first time, in the thread that does.
  AgentsOnTopics(Domain& domain, const Experiment& experiment, AgentRange agents,
                 const std::function<void()>& on_first_answer);

  bool Matched() const override;
  bool HaveAnswered() const override;
  void OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now) override;

 private:
  /// A runner that needs a sample, and the sender's index among the sources of that runner.
  struct Listener {
    AgentRunner* runner;
    std::size_t source;
  };

  void ListenToStates(Domain& domain);
  void ListenToMessages(Domain& domain);
  void ListenToActions(Domain& domain, AgentRange agents);
  /// For each agent, by id, the runners that listen to it. With `own`, an agent's runner listens to the agent itself,
  /// too.
  std::map<int, std::vector<Listener>> Listeners(bool own) const;

  const Experiment& experiment_;
  std::vector<std::unique_ptr<AgentRunner>> runners_;
  std::vector<std::unique_ptr<ReaderBase>> readers_;  // last, so destroyed first: they call the members above
};

}  // namespace mascot
