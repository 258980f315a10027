#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "agent/agent.h"
#include "agent/low_level.h"
#include "agent/process/agents_on_wire.h"
#include "agent/process/bundle_inbox.h"
#include "bus/bundle.h"
#include "bus/bus.h"

namespace mascot {

/// network.delivery = "bundled": one sample brings all that the agents of this process may hear at a tick, and one
/// takes all their answers back. Actions, which do not come from the physics server, come by themselves.
class AgentsOnBundles final : public AgentsOnWire {
 public:
  /// `on_first_answer` is called once, in the thread that answers first.
  AgentsOnBundles(Domain& domain, const Experiment& experiment, AgentRange agents,
                  std::function<void()> on_first_answer);

  bool Matched() const override;
  bool HaveAnswered() const override { return has_answered_; }
  void OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now) override;

 private:
  void OnBundle(const RawReader::Bytes& bytes);
  void OnAction(int id, std::int64_t tick, std::span<const double> action);
  // The functions below are called with mutex_ held.
  /// Lets the agents adopt what the first `events` events have made of the experiment.
  void TakeEvents(int events);
  /// Runs the agents on the tick of the inbox and writes their answers.
  void Answer();

  const Experiment& experiment_;
  const std::function<void()> on_first_answer_;

  std::mutex mutex_;  // guards what is below except the endpoints: readers may call in different threads
  std::vector<std::unique_ptr<Agent>> agents_;
  LowLevel low_level_;
  std::vector<Controller::Input> driven_;  // by agent
  std::vector<Command> commands_;
  BundleInbox inbox_;
  std::deque<std::pair<int, std::shared_ptr<const Experiment>>> events_;  // not yet adopted, by number
  BundleWriter sample_;
  std::atomic<bool> has_answered_ = false;

  RawWriter answers_;
  std::vector<std::unique_ptr<ReaderBase>> actions_;  // these two last: they call the members above
  RawReader bundles_;
};

}  // namespace mascot
