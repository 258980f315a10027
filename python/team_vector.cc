#include "python/team_vector.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/same_floating_point.h"
#include "base/state_numbers.h"

namespace mascot {

bool IsTerminated(const TeamEnv& env) {
  if (!env.failure().empty()) return true;
  for (std::size_t k = 0; k < env.agents().size(); ++k)
    if (!env.is_lost(k)) return false;
  return true;
}

/// Calls work(env) for all environments, in threads. Each thread begins with those that it had the last time, which are
/// in the caches of its core, and then helps the others.
template <class Work>
void TeamVector::ForEach(const Work& work) {
  struct alignas(64) Share {
    std::atomic<std::size_t> next = 0;
    std::size_t end = 0;
  };
  const auto threads = static_cast<std::size_t>(crew_.members());
  std::vector<Share> shares(threads);
  for (std::size_t k = 0; k < threads; ++k) {
    shares[k].next = k * envs_.size() / threads;
    shares[k].end = (k + 1) * envs_.size() / threads;
  }
  crew_.Do(threads, [&](std::size_t thread) {
    const SameFloatingPoint same;
    for (std::size_t k = 0; k < threads; ++k) {
      Share& share = shares[(thread + k) % threads];
      for (std::size_t env = share.next++; env < share.end; env = share.next++) work(env);
    }
  });
}

TeamVector::TeamVector(const std::string& text, const std::string& path, const std::vector<Override>& overrides,
                       int count, int threads, Autoreset autoreset, bool keeps_states)
    : crew_(std::min(threads, count)),
      autoreset_(autoreset),
      keeps_states_(keeps_states),
      envs_(static_cast<std::size_t>(count)),
      reached_(envs_.size()) {
  ForEach([&](std::size_t env) {
    envs_[env] = std::make_unique<TeamEnv>(text, path, overrides, Episodes::Keeps::kNothing);
  });
  all_given_.assign(first().agents().size(), 1);
}

void TeamVector::Reset(std::span<const std::optional<std::uint64_t>> seeds,
                       const std::optional<std::vector<Override>>& sets, std::span<const char> mask, Observations to) {
  ForEach([&](std::size_t env) {
    if (mask[env]) {
      envs_[env]->Reset(seeds[env], sets);
      reached_[env] = {};
    }
    Observe(env, to);
  });
}

void TeamVector::Step(std::span<const double> actions, Observations to) {
  const std::size_t numbers = first().agents().size() * first().action_size();
  ForEach([&](std::size_t env) {
    StepOne(env, actions.subspan(env * numbers, numbers));
    Observe(env, to);
  });
}

void TeamVector::StepOne(std::size_t env, std::span<const double> actions) {
  TeamEnv& team = *envs_[env];
  Reached& reached = reached_[env];
  const bool was_over = reached.terminated || reached.truncated;
  reached.was_reset = false;
  reached.terminated = reached.truncated = false;
  if (was_over && autoreset_ == Autoreset::kNextStep) {
    team.Reset({}, {});
    reached.was_reset = true;
  } else {
    team.Step(actions, all_given_);
    reached.terminated = IsTerminated(team);
    reached.truncated = team.is_at_end();
  }
  if (keeps_states_) {
    reached.state.resize(team.experiment().agents.size() * kStateNumbers);
    team.StateTo(reached.state);
  }
  reached.disagreement_m = team.disagreement_m();
  reached.failure = team.failure();
  reached.is_lost.clear();
  for (std::size_t k = 0; k < team.agents().size(); ++k) reached.is_lost.push_back(team.is_lost(k));
  reached.any_is_lost = std::ranges::find(reached.is_lost, 1) != reached.is_lost.end();
  if ((reached.terminated || reached.truncated) && autoreset_ == Autoreset::kSameStep) {
    reached.observations.assign(team.observations().begin(), team.observations().end());
    team.Reset({}, {});
    reached.was_reset = true;
  }
}

void TeamVector::Observe(std::size_t env, Observations to) const {
  const std::span<const double> from = envs_[env]->observations();
  std::visit(
      [&]<class Number>(std::span<Number> numbers) {
        std::ranges::transform(from, numbers.begin() + static_cast<std::ptrdiff_t>(env * from.size()),
                               [](double number) { return static_cast<Number>(number); });
      },
      to);
}

}  // namespace mascot
