#include "orchestrator/engines/dds/replay_delivery.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "bus/bundle.h"
#include "experiment/processes.h"
#include "physics_server/process/agents_bundle.h"

namespace mascot {
namespace {

std::span<const std::uint8_t> BodyOfSample(const Row::Bytes& sample) {
  return std::span(sample).subspan(std::min(sample.size(), kEncapsulation.size()));
}

Row::Bytes SampleOfBody(std::span<const std::uint8_t> body) {
  Row::Bytes sample;
  std::ranges::copy(body, BodyIn(sample, body.size()));
  return sample;
}

class ReplayOfBundles final : public ReplayDelivery {
 public:
  ReplayOfBundles(Domain& domain, const Experiment& experiment, int agent, OnAnswer on_answer)
      : process_(ProcessName({agent, agent})),
        asks_again_(AsksAgain(experiment)),
        bundle_(experiment, {agent, agent}),
        on_answer_(std::move(on_answer)),
        bundles_(domain, Topic::Bundle(bundle_.agents()), RedeliveryOfBundles(domain, experiment)),
        answers_(
            domain, Topic::Answers(bundle_.agents()),
            [this](const RawReader::Bytes& bytes, const Sender& /*sender*/) { OnSample(bytes); },
            RedeliveryOfBundles(domain, experiment)) {}

  bool Matched() const override { return bundles_.HasReaderOf(process_) && answers_.matched() >= 1; }

  void Publish(const Row& row, std::span<const Row::Bytes> messages) override {
    SampleBodies sent;
    bundle_.Make(
        row.tick, [&row](int id) { return BodyOfSample(row.states[static_cast<std::size_t>(id - 1)]); },
        [&](int id) -> const SampleBodies& {
          const Row::Bytes& message = messages[static_cast<std::size_t>(id - 1)];
          sent.Clear();
          if (!message.empty()) sent.Add(BodyOfSample(message));
          return sent;
        });
    bundles_.Write(bundle_.bytes());
  }

  void AskAgain() override {
    if (asks_again_) bundles_.Write(bundle_.bytes());
  }

 private:
  void OnSample(const RawReader::Bytes& bytes) {
    BundleReader sample(bytes);
    const BundleReader::Section commands = sample.Next(kCommandBody);
    const auto messages = sample.NextMessages();
    sample.End();
    if (commands.count != 1 || messages.size() > 1)
      throw std::runtime_error(fmt::format("{}: expected one command and one message at most, got {} and {}",
                                           Topic::Answers(bundle_.agents()).Name(), commands.count, messages.size()));
    Answer answer{.tick = static_cast<std::int64_t>(sample.tick()), .command = SampleOfBody(commands[0])};
    if (!messages.empty()) answer.message = SampleOfBody(messages[0]);
    on_answer_(answer);
  }

  const std::string process_;
  const bool asks_again_;
  AgentsBundle bundle_;
  const OnAnswer on_answer_;
  RawWriter bundles_;
  RawReader answers_;  // last: it calls the members above
};

class ReplayOfTopics final : public ReplayDelivery {
 public:
  ReplayOfTopics(Domain& domain, const Experiment& experiment, int agent, OnAnswer on_answer)
      : process_(ProcessName({agent, agent})),
        sends_messages_(experiment.agent(agent).sends_messages),
        on_answer_(std::move(on_answer)) {
    for (const int id : SourcesOf(experiment, {agent, agent})) {
      states_.emplace_back(id, std::make_unique<RawWriter>(domain, Topic::State(id)));
      if (id != agent && experiment.agent(id).sends_messages)
        messages_.emplace_back(id, std::make_unique<RawWriter>(domain, Topic::Message(id)));
    }
    const auto listen = [&](const Topic& topic, Row::Bytes Answer::*sample) {
      readers_.push_back(std::make_unique<RawReader>(
          domain, topic, [this, sample, topic](const RawReader::Bytes& bytes, const Sender& /*sender*/) {
            OnSample(topic, bytes, sample);
          }));
    };
    listen(Topic::Command(agent), &Answer::command);
    if (sends_messages_) listen(Topic::Message(agent), &Answer::message);
  }

  bool Matched() const override {
    const auto is_read = [this](const auto& writer) { return writer.second->HasReaderOf(process_); };
    return std::ranges::all_of(states_, is_read) && std::ranges::all_of(messages_, is_read) &&
           std::ranges::all_of(readers_, [](const auto& reader) { return reader->matched() >= 1; });
  }

  void Publish(const Row& row, std::span<const Row::Bytes> messages) override {
    for (const auto& [id, writer] : messages_) {
      Row::Bytes message = messages[static_cast<std::size_t>(id - 1)];
      if (!message.empty()) writer->Write(message);
    }
    for (const auto& [id, writer] : states_) {
      Row::Bytes state = row.states[static_cast<std::size_t>(id - 1)];
      writer->Write(state);
    }
  }

  void AskAgain() override {}  // DDS does

 private:
  using Writers = std::vector<std::pair<int, std::unique_ptr<RawWriter>>>;

  /// A command or message; calls on_answer_ once there is all of a tick.
  void OnSample(const Topic& topic, const Row::Bytes& bytes, Row::Bytes Answer::*sample) {
    if (bytes.size() < kEncapsulation.size() + MessageBody(0)) ThrowNoSample(topic, bytes.size(), "answer");
    const auto tick = static_cast<std::int64_t>(HeadOf(bytes.data() + kEncapsulation.size()).tick);
    const std::lock_guard lock(mutex_);
    Answer& answer = answers_[tick];
    answer.tick = tick;
    answer.*sample = bytes;
    if (answer.command.empty() || (sends_messages_ && answer.message.empty())) return;
    on_answer_(answer);
    answers_.erase(answers_.begin(), answers_.upper_bound(tick));
  }

  const std::string process_;
  const bool sends_messages_;
  const OnAnswer on_answer_;
  std::mutex mutex_;
  std::map<std::int64_t, Answer> answers_;           // by tick: those that are not whole yet
  Writers states_, messages_;                        // by id of the agents that they speak of
  std::vector<std::unique_ptr<RawReader>> readers_;  // last: they call the members above
};

}  // namespace

std::unique_ptr<ReplayDelivery> MakeReplayDelivery(Domain& domain, const Experiment& experiment, int agent,
                                                   ReplayDelivery::OnAnswer on_answer) {
  if (experiment.network.is_bundled())
    return std::make_unique<ReplayOfBundles>(domain, experiment, agent, std::move(on_answer));
  return std::make_unique<ReplayOfTopics>(domain, experiment, agent, std::move(on_answer));
}

}  // namespace mascot
