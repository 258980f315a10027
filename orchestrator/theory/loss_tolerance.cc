#include "orchestrator/theory/loss_tolerance.h"

#include <fmt/format.h>

#include <utility>

#include "agent/laws/laws.h"
#include "agent/laws/parts/reach.h"
#include "orchestrator/theory/team_network.h"

namespace mascot {
namespace {

/// "agent 1, 3 or 4 (the leader)"
std::string AnyOf(const std::vector<int>& ids, int leader) {
  constexpr std::size_t kShown = 5;
  if (ids.size() > kShown) return "any of " + AgentList(ids);
  std::string text = "agent ";
  for (std::size_t k = 0; k < ids.size(); ++k)
    text += fmt::format("{}{}{}",
                        k == 0                ? ""
                        : k + 1 == ids.size() ? " or "
                                              : ", ",
                        ids[k], ids[k] == leader ? " (the leader)" : "");
  return text;
}

std::string ToleranceText(const LossTolerance& tolerance, const Experiment& experiment, std::size_t count) {
  if (!tolerance.is_known) return "which agents the team cannot lose is not looked at: it has too many edges";
  const std::vector<int>& ids = tolerance.cannot_lose;
  const std::string others =
      HullOf(experiment.law).empty() ? "the others have no spanning tree" : "not all of the others hear a leader";
  if (ids.empty()) return "any one agent may be lost";
  if (ids.size() == 1 && ids.front() == experiment.law.leader)
    return fmt::format("any one agent may be lost, but not {}, the leader", ids.front());
  if (ids.size() == count) return "whichever agent is lost, " + others;
  return fmt::format("without {} {}", AnyOf(ids, experiment.law.leader), others);
}

}  // namespace

std::optional<LossTolerance> LossToleranceOf(const Experiment& experiment) {
  if (!NeedsTree(experiment)) return std::nullopt;
  const double end_s = experiment.run.duration_s;
  std::vector<bool> is_there;
  for (const AgentConfig& agent : experiment.agents) is_there.push_back(agent.stop_s >= end_s);
  const bool repeats = experiment.schedule.repeat_s() > 0;
  const Graph graph = repeats ? experiment.schedule.Union() : experiment.schedule.phases().back().graph;
  const TeamNetwork network = NetworkOf(experiment, graph, std::move(is_there));
  const std::vector<int> ids = network.Ids(), leaders = LeadersOf(experiment);
  Budget budget(kMaxSurvivalWork);
  if (ids.size() < 3 || !HasTree(network, leaders, 0, budget)) return std::nullopt;
  LossTolerance tolerance;
  for (const int id : ids) {
    if (!HasTree(network, leaders, id, budget)) tolerance.cannot_lose.push_back(id);
    tolerance.is_known = !budget.is_spent();
    if (!tolerance.is_known) break;
  }
  if (!tolerance.is_known) tolerance.cannot_lose.clear();
  tolerance.words = ToleranceText(tolerance, experiment, ids.size());
  return tolerance;
}

}  // namespace mascot
