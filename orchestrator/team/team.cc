#include "orchestrator/team/team.h"

#include <algorithm>
#include <exception>
#include <iterator>

namespace mascot {

Team::Part::Part(const Experiment& experiment, AgentRange agents)
    : ids(agents), low_level(experiment, agents), driven(static_cast<std::size_t>(agents.size())) {}

Team::Team(const Experiment& experiment, Crew& crew) : crew_(crew), exchange_(experiment) {
  const std::size_t agents = experiment.agents.size(), parts = crew.PartsOf(agents, kMinAgentsPerThread);
  for (const AgentConfig& config : experiment.agents) agents_.push_back(std::make_unique<Agent>(experiment, config.id));
  takes_turns_ = AnyAsksCodeOfUser();
  has_answered_.assign(agents, true);
  for (std::size_t k = 0; k < parts; ++k)
    parts_.emplace_back(
        experiment, AgentRange{static_cast<int>(k * agents / parts) + 1, static_cast<int>((k + 1) * agents / parts)});
}

void Team::Adopt(const std::shared_ptr<const Experiment>& now) {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    agents_[i]->Adopt(now);
    has_answered_[i] = !agents_[i]->is_lost();
  }
  for (Part& part : parts_) part.low_level.Adopt(*now);
  takes_turns_ = AnyAsksCodeOfUser();
}

bool Team::AnyAsksCodeOfUser() const {
  return std::ranges::any_of(agents_, [](const auto& agent) { return agent->AsksCodeOfUser(); });
}

template <class Work>
void Team::ForEachPart(Work&& work) {
  if (takes_turns_)
    for (Part& part : parts_) work(part);
  else
    crew_.Do(parts_.size(), [&](std::size_t k) { work(parts_[k]); });
}

void Team::Sense(std::int64_t tick, std::span<const Motion> motions, int id, std::vector<Sample>& samples) {
  const auto i = static_cast<std::size_t>(id - 1);
  agents_[i]->Sense(tick, motions[i], exchange_.SamplesFor(id, motions, samples));
}

void Team::Sense(std::int64_t tick, std::span<const Motion> motions) {
  ForEachPart([&](Part& part) {
    for (int id = part.ids.first; id <= part.ids.last; ++id)
      if (!agents_[static_cast<std::size_t>(id - 1)]->is_lost()) Sense(tick, motions, id, part.samples);
  });
  sensed_ = tick;
}

void Team::Decide(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands,
                  std::span<const int> silent, std::vector<Failure>* failures) {
  for (const int id : silent) has_answered_[static_cast<std::size_t>(id - 1)] = false;
  ForEachPart([&](Part& part) {
    Want(tick, motions, commands, part, failures != nullptr);
    Actuate(commands, part);
  });
  exchange_.EndTick();
  CollectFailures(failures);
}

void Team::Want(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands,
                std::vector<Failure>* failures) {
  ForEachPart([&](Part& part) { Want(tick, motions, commands, part, failures != nullptr); });
  exchange_.EndTick();
  CollectFailures(failures);
}

void Team::CollectFailures(std::vector<Failure>* failures) {
  if (failures == nullptr) return;
  failures->clear();
  for (Part& part : parts_) {
    std::ranges::move(part.failures, std::back_inserter(*failures));
    part.failures.clear();
  }
}

void Team::TakeBack(int id) {
  has_answered_[static_cast<std::size_t>(id - 1)] = false;
  exchange_.TakeBack(id);
}

void Team::Want(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands, Part& part,
                bool failures_count) {
  for (int id = part.ids.first; id <= part.ids.last; ++id) {
    const auto i = static_cast<std::size_t>(id - 1);
    if (!HasAnswered(id)) {
      exchange_.Send(id, {});
      continue;
    }
    Agent& agent = *agents_[i];
    try {
      if (sensed_ != tick) Sense(tick, motions, id, part.samples);
      commands[i] = agent.Decide();
    } catch (const std::exception& failure) {
      if (!failures_count) throw;
      part.failures.push_back({id, failure.what()});
      has_answered_[i] = false;
      exchange_.Send(id, {});
      continue;
    }
    exchange_.Send(id, agent.message());
  }
}

void Team::Actuate(std::span<Command> commands, Part& part) {
  const auto first = static_cast<std::size_t>(part.ids.first - 1);
  const std::span<Command> own = commands.subspan(first, part.driven.size());
  part.kept.clear();
  for (std::size_t k = 0; k < own.size(); ++k) {
    if (has_answered_[first + k] == 0) part.kept.emplace_back(k, own[k]);
    part.driven[k] = agents_[first + k]->Driven(own[k]);
  }
  part.low_level.Actuate(part.driven, own);
  for (const auto& [k, command] : part.kept) own[k] = command;
}

}  // namespace mascot
