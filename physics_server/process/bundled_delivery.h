#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "base/agent_range.h"
#include "bus/bundle.h"
#include "experiment/silences.h"
#include "physics_server/process/agents_bundle.h"
#include "physics_server/process/delivery.h"

namespace mascot {

/// network.delivery = "bundled": one sample to each process, with the states and messages that its agents may hear; one
/// back from each process, with the answers of all its agents; and one to the recorder, with all states of the tick and
/// all that was answered since the tick before.
class BundledDelivery final : public Delivery {
 public:
  BundledDelivery(Domain& domain, const Experiment& experiment, OnAnswers on_answers);

  bool Matched() const override;
  bool Matched(AgentRange agents) const override;
  void Publish(const World& world, int events) override;
  void Take(const Event& event) override;
  bool Lose(int id) override;
  void AskAgain() override;
  void CompleteRow() override;
  void Finish() override;

 private:
  /// What is sent to a process of agents, and comes from it.
  struct Process {
    AgentsBundle bundle;  ///< of the newest tick
    AgentRange agents;
    std::vector<Answer> answers = {};  ///< in the newest sample
    std::int64_t answered = -1;        ///< the newest tick that the process has answered
    std::vector<int> answering = {};   ///< scratch: ids
    std::unique_ptr<RawWriter> bundles = {};
  };

  void OnSample(Process& process, const RawReader::Bytes& bytes);
  // The functions below are called with mutex_ held.
  /// Takes what a process has answered to `tick`, into its answers and the next row. Throws std::runtime_error for
  /// answers that it should not send.
  void TakeAnswers(std::int64_t tick, const BundleReader::Section& commands,
                   std::span<const std::span<const std::uint8_t>> messages, Process& process);
  /// Whether any agent of a process answers this tick.
  bool IsAnsweredBy(const Process& process, std::int64_t tick) const;
  /// Whether all processes have answered the newest tick, but for those whose agents are lost.
  bool IsAnswered() const;
  /// Writes a row for the recorder: these states, and what was answered since the last row.
  void WriteRow(std::int64_t tick, const SampleBodies& states);

  const Experiment& experiment_;
  const OnAnswers on_answers_;
  const bool asks_again_;
  RawWriter rows_;
  SampleBodies states_;  // of the tick that is published
  BundleWriter row_;

  std::mutex mutex_;                  // guards what is below, which is of the time since the last Publish()
  SampleBodies commands_, messages_;  // as they came
  std::vector<SampleBodies> sent_;    // messages, by id - 1
  std::int64_t published_ = -1;       // the newest tick
  Silences silences_;
  std::vector<char> is_lost_;  // by id - 1: its answers are not taken, also before the event that says so
  // By id - 1: the newest tick of which a command and a message were kept. An agent may answer twice.
  std::vector<std::int64_t> commanded_, said_;

  std::vector<std::unique_ptr<Process>> processes_;
  // By process. Last, so that they end first: what they hear may be written on to any process.
  std::vector<std::unique_ptr<RawReader>> readers_;
};

}  // namespace mascot
