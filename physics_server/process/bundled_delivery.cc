#include "physics_server/process/bundled_delivery.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "experiment/processes.h"

namespace mascot {
namespace {

std::span<const std::uint8_t> BodyAt(const SampleBodies& bodies, std::size_t k, std::size_t size) {
  return std::span(bodies.bytes).subspan(k * size, size);
}

}  // namespace

BundledDelivery::BundledDelivery(Domain& domain, const Experiment& experiment, OnAnswers on_answers)
    : experiment_(experiment),
      on_answers_(std::move(on_answers)),
      asks_again_(AsksAgain(experiment)),
      rows_(domain, Topic::Row()),
      sent_(experiment.agents.size()),
      is_lost_(experiment.agents.size()),
      commanded_(experiment.agents.size(), -1),
      said_(experiment.agents.size(), -1) {
  const Redelivery redelivery = RedeliveryOfBundles(domain, experiment);
  for (const AgentRange& agents : AgentProcesses(experiment)) {
    Process& process = *processes_.emplace_back(
        std::make_unique<Process>(Process{.bundle = AgentsBundle(experiment, agents), .agents = agents}));
    process.bundles = std::make_unique<RawWriter>(domain, Topic::Bundle(agents), redelivery);
  }
  for (const auto& process : processes_)
    readers_.push_back(std::make_unique<RawReader>(
        domain, Topic::Answers(process->agents),
        [this, &process](const RawReader::Bytes& bytes, const Sender& /*sender*/) { OnSample(*process, bytes); },
        redelivery));
}

bool BundledDelivery::Matched() const {
  return rows_.matched() >= 1 &&
         std::ranges::all_of(processes_, [](const auto& process) { return process->bundles->matched() >= 1; }) &&
         std::ranges::all_of(readers_, [](const auto& reader) { return reader->matched() >= 1; });
}

bool BundledDelivery::Matched(AgentRange agents) const {
  for (std::size_t k = 0; k < processes_.size(); ++k)
    if (processes_[k]->agents == agents) return processes_[k]->bundles->matched() >= 1 && readers_[k]->matched() >= 1;
  return false;
}

void BundledDelivery::Publish(const World& world, int events) {
  states_.Clear();
  states_.count = static_cast<std::uint32_t>(experiment_.size());
  states_.bytes.resize(kStateBody * states_.count);
  for (int id = 1; id <= experiment_.size(); ++id)
    PutState(world.tick(), experiment_.control.rate_hz, id, events, world.State(id),
             states_.bytes.data() + kStateBody * static_cast<std::size_t>(id - 1));
  const std::lock_guard lock(mutex_);
  for (const auto& process : processes_) {
    if (!IsAnsweredBy(*process, world.tick())) continue;
    process->bundle.Make(
        world.tick(), [this](int id) { return BodyAt(states_, static_cast<std::size_t>(id - 1), kStateBody); },
        [this](int id) -> const SampleBodies& { return sent_[static_cast<std::size_t>(id - 1)]; });
    process->bundles->Write(process->bundle.bytes());
  }
  WriteRow(world.tick(), states_);
  for (SampleBodies& sent : sent_) sent.Clear();
  published_ = world.tick();
}

void BundledDelivery::Take(const Event& event) {
  const std::lock_guard lock(mutex_);
  silences_.Take(event);
  if (event.fault && event.fault->IsLoss()) is_lost_[static_cast<std::size_t>(event.fault->agent - 1)] = true;
  if (event.restart) is_lost_[static_cast<std::size_t>(*event.restart - 1)] = false;
}

bool BundledDelivery::Lose(int id) {
  const std::lock_guard lock(mutex_);
  is_lost_[static_cast<std::size_t>(id - 1)] = true;
  return commanded_[static_cast<std::size_t>(id - 1)] == published_;
}

bool BundledDelivery::IsAnsweredBy(const Process& process, std::int64_t tick) const {
  if (silences_.empty()) return true;
  for (int id = process.agents.first; id <= process.agents.last; ++id)
    if (!silences_.Has(id, tick)) return true;
  return false;
}

bool BundledDelivery::IsAnswered() const {
  return std::ranges::all_of(processes_, [this](const auto& process) {
    return process->answered == published_ || !IsAnsweredBy(*process, published_);
  });
}

void BundledDelivery::AskAgain() {
  if (!asks_again_) return;
  const std::lock_guard lock(mutex_);
  for (const auto& process : processes_)
    if (process->answered < published_ && IsAnsweredBy(*process, published_))
      process->bundles->Write(process->bundle.bytes());
}

void BundledDelivery::CompleteRow() {
  const std::lock_guard lock(mutex_);
  if (commands_.count > 0 && IsAnswered()) WriteRow(published_ + 1, {});
}

void BundledDelivery::Finish() {
  const std::lock_guard lock(mutex_);
  if (commands_.count > 0) WriteRow(published_ + 1, {});
}

void BundledDelivery::WriteRow(std::int64_t tick, const SampleBodies& states) {
  row_.Begin(tick);
  for (const SampleBodies* bodies : std::initializer_list<const SampleBodies*>{&states, &commands_, &messages_}) {
    row_.BeginSection();
    row_.Add(*bodies);
  }
  rows_.Write(row_.bytes());
  commands_.Clear();
  messages_.Clear();
}

void BundledDelivery::OnSample(Process& process, const RawReader::Bytes& bytes) {
  BundleReader sample(bytes);
  const BundleReader::Section commands = sample.Next(kCommandBody);
  const auto messages = sample.NextMessages();
  sample.End();
  const auto topic = [&process] { return Topic::Answers(process.agents).Name(); };
  if (std::cmp_greater(sample.tick(), experiment_.ticks()) || std::cmp_greater(commands.count, process.agents.size()))
    throw std::runtime_error(fmt::format("{}: expected a tick of 0 to {} and {} commands at most, got tick {} and {}",
                                         topic(), experiment_.ticks(), process.agents.size(), sample.tick(),
                                         commands.count));
  const auto tick = static_cast<std::int64_t>(sample.tick());
  process.answers.clear();
  {
    const std::lock_guard lock(mutex_);
    if (tick > published_)
      throw std::runtime_error(fmt::format("{}: answers to tick {}, of which there are no states yet", topic(), tick));
    TakeAnswers(tick, commands, messages, process);
  }
  on_answers_(process.answers);
}

void BundledDelivery::TakeAnswers(std::int64_t tick, const BundleReader::Section& commands,
                                  std::span<const std::span<const std::uint8_t>> messages, Process& process) {
  std::vector<int>& answering = process.answering;
  answering.clear();
  for (int id = process.agents.first; id <= process.agents.last; ++id)
    if (silences_.empty() || !silences_.Has(id, tick)) answering.push_back(id);
  const auto is_lost = [this](int id) { return is_lost_[static_cast<std::size_t>(id - 1)] != 0; };
  if (answering.empty() || std::ranges::all_of(answering, is_lost)) return;  // of a process that was too late
  const auto require = [&](const BodyHead& head, bool fits) {
    if (!fits || std::cmp_not_equal(head.tick, tick))
      throw std::runtime_error(fmt::format("{}: an answer of agent {} to tick {} among those to tick {}",
                                           Topic::Answers(process.agents).Name(), head.agent, head.tick, tick));
  };
  if (std::cmp_not_equal(commands.count, answering.size()))
    throw std::runtime_error(fmt::format("{}: expected {} commands at tick {}, got {}",
                                         Topic::Answers(process.agents).Name(), answering.size(), tick,
                                         commands.count));
  for (std::size_t k = 0; k < answering.size(); ++k)
    require(HeadOf(commands[k].data()), std::cmp_equal(HeadOf(commands[k].data()).agent, answering[k]));
  for (const auto& message : messages) {
    const BodyHead head = HeadOf(message.data());
    require(head, std::ranges::binary_search(answering, static_cast<int>(head.agent)));
  }
  const auto is_new = [tick](std::int64_t& newest) { return tick > newest && (newest = tick, true); };
  process.answered = std::max(process.answered, tick);
  for (std::size_t k = 0; k < answering.size(); ++k) {
    const int id = answering[k];
    if (is_lost(id)) continue;
    process.answers.push_back({.id = id, .tick = tick, .actuator = ActuationOf(commands[k].data())});
    if (is_new(commanded_[static_cast<std::size_t>(id - 1)])) commands_.Add(commands[k]);
  }
  for (const auto& message : messages) {
    const std::size_t sender = HeadOf(message.data()).agent - 1;
    if (is_lost_[sender] != 0 || !is_new(said_[sender])) continue;
    messages_.Add(message);
    sent_[sender].Add(message);
  }
}

}  // namespace mascot
