#include "agent/process/agents_on_bundles.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "agent/process/action_readers.h"

namespace mascot {

static_assert(kMaxMessage == kMaxNumbers);

AgentsOnBundles::AgentsOnBundles(Domain& domain, const Experiment& experiment, AgentRange agents,
                                 std::function<void()> on_first_answer)
    : experiment_(experiment),
      on_first_answer_(std::move(on_first_answer)),
      low_level_(experiment, agents),
      driven_(static_cast<std::size_t>(agents.size())),
      commands_(driven_.size()),
      inbox_(experiment, agents),
      answers_(domain, Topic::Answers(agents), RedeliveryOfBundles(domain, experiment)),
      actions_(ActionReaders(
          domain, experiment, agents,
          [this](int id, std::int64_t tick, std::span<const double> action) { OnAction(id, tick, action); })),
      bundles_(
          domain, Topic::Bundle(agents),
          [this](const RawReader::Bytes& bytes, const Sender& /*sender*/) { OnBundle(bytes); },
          RedeliveryOfBundles(domain, experiment)) {
  const std::lock_guard lock(mutex_);
  for (int id = agents.first; id <= agents.last; ++id) agents_.push_back(std::make_unique<Agent>(experiment, id));
  for (const auto& agent : agents_) agent->AwaitLaw();
}

bool AgentsOnBundles::Matched() const {
  return bundles_.matched() >= 1 && answers_.matched() >= 1 &&
         std::ranges::all_of(actions_, [](const auto& reader) { return reader->matched() >= 1; });
}

void AgentsOnBundles::OnBundle(const RawReader::Bytes& bytes) {
  const std::lock_guard lock(mutex_);
  switch (inbox_.OnBundle(bytes)) {
    case BundleInbox::News::kComplete:
      return Answer();
    case BundleInbox::News::kAgain:
      return answers_.Write(sample_.bytes());
    case BundleInbox::News::kOld:
    case BundleInbox::News::kWaits:
      return;
  }
}

void AgentsOnBundles::OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now) {
  const std::lock_guard lock(mutex_);
  events_.emplace_back(number, now);
  if (inbox_.OnEvent(number, event)) Answer();
}

void AgentsOnBundles::OnAction(int id, std::int64_t tick, std::span<const double> action) {
  const std::lock_guard lock(mutex_);
  if (inbox_.OnAction(id, tick, action)) Answer();
}

void AgentsOnBundles::TakeEvents(int events) {
  std::shared_ptr<const Experiment> now;
  for (; !events_.empty() && events_.front().first <= events; events_.pop_front())
    if (events_.front().second) now = events_.front().second;
  if (!now) return;
  for (const auto& agent : agents_) agent->Adopt(now);
  low_level_.Adopt(*now);
}

void AgentsOnBundles::Answer() {
  const std::int64_t tick = inbox_.tick();
  const int rate_hz = experiment_.control.rate_hz;
  TakeEvents(inbox_.events());
  inbox_.Answered();
  if (std::ranges::all_of(agents_, [](const auto& agent) { return agent->is_lost(); })) return;
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    const int id = agents_[i]->id();
    if (!agents_[i]->is_lost()) {
      if (const auto action = inbox_.ActionOf(id); !action.empty()) agents_[i]->Act(action);
      commands_[i] = agents_[i]->Want(tick, inbox_.MotionOf(id), inbox_.SamplesOf(id));
    }
    driven_[i] = agents_[i]->Driven(commands_[i]);
  }
  low_level_.Actuate(driven_, commands_);
  sample_.Begin(tick);
  sample_.BeginSection();
  for (std::size_t i = 0; i < agents_.size(); ++i)
    if (!agents_[i]->is_lost()) PutCommand(tick, rate_hz, agents_[i]->id(), commands_[i], sample_.Add(kCommandBody));
  sample_.BeginSection();
  for (const auto& agent : agents_) {
    if (agent->is_lost() || !experiment_.agent(agent->id()).sends_messages) continue;
    const std::span<const double> message = agent->message();
    PutMessage(tick, rate_hz, agent->id(), message, sample_.Add(MessageBody(message.size())));
  }
  answers_.Write(sample_.bytes());
  if (!has_answered_.exchange(true)) on_first_answer_();
}

}  // namespace mascot
