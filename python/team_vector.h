#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/crew.h"
#include "python/team_env.h"

namespace mascot {

/// Many environments of one experiment, which threads step together. Arrays have a row for each environment; what
/// threads compute does not depend on their number.
class TeamVector {
 public:
  /// When an environment whose episode is over is reset by itself.
  enum class Autoreset {
    kNextStep,  ///< by the next step, which does nothing else with it
    kSameStep,  ///< by the step that ends the episode
    kDisabled   ///< never
  };

  /// `count` environments, computed by `threads` threads. `keeps_states`: whether Reached::state is wanted. Throws what
  /// TeamEnv throws.
  TeamVector(const std::string& text, const std::string& path, const std::vector<Override>& overrides, int count,
             int threads, Autoreset autoreset, bool keeps_states);

  std::size_t size() const { return envs_.size(); }
  /// One of them: all have the same agents, layout and bounds.
  const TeamEnv& first() const { return *envs_.front(); }
  TeamEnv& at(std::size_t env) { return *envs_.at(env); }

  /// What the environments observe, one after the other, in the type of whoever asks.
  using Observations = std::variant<std::span<float>, std::span<double>>;

  /// Resets those whose `mask` is not 0, as TeamEnv::Reset(). `to` gets what all observe then.
  void Reset(std::span<const std::optional<std::uint64_t>> seeds, const std::optional<std::vector<Override>>& sets,
             std::span<const char> mask, Observations to);
  /// Goes on by a tick in all environments; `actions` has the rows of TeamEnv::Step(), one environment after the other.
  /// `to` gets what they observe then. Throws what TeamEnv::Step() throws, for one of those that fail. An environment
  /// whose episode is over fails, unless it is reset by itself.
  void Step(std::span<const double> actions, Observations to);

  /// How an environment was at the tick that the last Step() has reached, before a reset at that step.
  struct alignas(64) Reached {              // written by one thread
    std::vector<double> state = {};         ///< TeamEnv::StateTo(), if it is wanted
    std::vector<double> observations = {};  ///< only if the environment was reset at this step
    std::vector<char> is_lost = {};
    bool any_is_lost = false;
    double disagreement_m = 0;
    bool terminated = false;  ///< all agents are lost, or the run cannot go on
    bool truncated = false;   ///< the last tick of run.duration_s
    bool was_reset = false;   ///< at this step
    std::string failure = {};
  };
  const Reached& reached(std::size_t env) const { return reached_[env]; }

 private:
  template <class Work>
  void ForEach(const Work& work);
  void StepOne(std::size_t env, std::span<const double> actions);
  void Observe(std::size_t env, Observations to) const;

  Crew crew_;
  const Autoreset autoreset_;
  const bool keeps_states_;
  std::vector<char> all_given_;  // of an environment's agents: each has an action
  std::vector<std::unique_ptr<TeamEnv>> envs_;
  std::vector<Reached> reached_;
};

/// Whether no agent that takes actions is left, or the run cannot go on without those that are lost.
bool IsTerminated(const TeamEnv& env);

}  // namespace mascot
