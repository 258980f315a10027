#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// What is wrong with agents at one time, and what the others can still do. Agents by id, in increasing order; an agent
/// whose law is not on yet, or not any more, is not counted among them.
struct Survival {
  std::int64_t from = 0;     ///< tick
  std::vector<int> lost;     ///< they answer nothing
  std::vector<int> unheard;  ///< nobody hears them, and they go on
  std::vector<int> deaf;     ///< they hear nobody, and go on
  std::vector<int> liars;    ///< what others hear of them is false
  bool ends_run = false;     ///< by run.on_agent_loss
  /// Whether a directed spanning tree reaches all that are not lost: from the leader or leaders, if the law has some,
  /// else from any of them. Absent: the law needs none, or nobody is left, or nothing is wrong.
  std::optional<bool> spanning_tree;
  /// Without a spanning tree: the agents that hear the leader (or any of the leaders) neither directly nor through
  /// others; without a leader, those that do not hear the group that most others hear.
  std::vector<int> cut_off;
  /// With liars, of the graph of those that are not lost: RobustnessOf() and F, the largest number for which the graph
  /// is (2F + 1)-robust. Absent beyond kMaxRobustness agents, or if the law needs no spanning tree.
  std::optional<int> robustness, liars_tolerated;
  int liars_heard = 0;  ///< the most that one agent hears that does not lie
  std::string words;    ///< all of it in words: "agent 3 is lost: the others have a spanning tree"

  bool IsAnythingWrong() const { return !lost.empty() || !unheard.empty() || !deaf.empty() || !liars.empty(); }
};

/// What follows from an experiment that events have changed to `now`, while no other event comes: the newest entry up
/// to a tick is for that tick, and there is none while nothing is wrong. Of what takes more than a tenth of
/// kMaxSurvivalWork (team_network.h), the words say only what is wrong, or later entries are missing.
std::vector<Survival> SurvivalsOf(const Experiment& now);

struct SurvivalOfRun {
  /// For each time at which it changes, also by the restarts that run.on_agent_loss brings; the first is that at which
  /// something is wrong first. Empty: nothing goes wrong.
  std::vector<Survival> moments;
  /// Changes from this tick on are not looked at, because they would take more than kMaxSurvivalWork.
  std::optional<std::int64_t> unknown_from;
};
/// `experiment`: as its file has it.
SurvivalOfRun SurvivalOf(const Experiment& experiment);

}  // namespace mascot
