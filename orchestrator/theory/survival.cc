#include "orchestrator/theory/survival.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "agent/laws/laws.h"
#include "agent/laws/parts/reach.h"
#include "agent/neighbours.h"
#include "agent/user_code/law_output.h"
#include "base/ticks.h"
#include "experiment/graph/robustness.h"
#include "experiment/live_experiment.h"
#include "orchestrator/theory/team_network.h"

namespace mascot {
namespace {

// --- what is wrong with an agent ------------------------------------------------------------------------

/// Whether others hear of the agent what is not, or no more, true, as if it were true now. A link that is slow, delayed
/// or intermittent brings the truth late or not at all: that is what links do, and no lie. What others hear of the
/// agent's position comes from its body, and a fault of its sensor does not change it; but what its law says in
/// messages comes from what it measures, and is false if that is (a measurement that is only late is none).
bool IsFalseToOthers(const AgentConfig& agent, double t_s) {
  if (agent.lie && agent.lie->IsToldAt(t_s)) return true;
  const Fault* link = FaultOf(agent, FaultPart::kLink);
  const auto falsifies = [](const Fault* fault) {
    return fault != nullptr &&
           (fault->kind == FaultKind::kStuck || fault->kind == FaultKind::kGarbage || fault->kind == FaultKind::kWrong);
  };
  if (falsifies(link)) return true;
  const bool sends_messages = agent.law.params != nullptr && agent.law.params->sends_messages;
  const Fault* sensor = FaultOf(agent, FaultPart::kSensor);
  return sends_messages && (falsifies(sensor) || (sensor != nullptr && sensor->kind == FaultKind::kOff));
}

// --- liars ----------------------------------------------------------------------------------------------

/// The graph of those that are there, numbered anew.
Graph GraphOf(const TeamNetwork& network) {
  const std::vector<int> ids = network.Ids();
  std::vector<int> numbers(network.is_there.size());  // by id - 1
  for (std::size_t k = 0; k < ids.size(); ++k) numbers[static_cast<std::size_t>(ids[k] - 1)] = static_cast<int>(k) + 1;
  std::vector<std::vector<Graph::Neighbour>> heard(ids.size());
  for (const int id : ids)
    for (const int hearer : network.HearersOf(id))
      heard[static_cast<std::size_t>(numbers[static_cast<std::size_t>(hearer - 1)] - 1)].push_back(
          {numbers[static_cast<std::size_t>(id - 1)], 1});
  return Graph(std::move(heard));
}

int MostHeardLiars(const TeamNetwork& network, const std::vector<int>& liars) {
  std::vector<int> count(network.is_there.size());  // by id - 1
  for (const int liar : liars)
    for (const int hearer : network.HearersOf(liar)) ++count[static_cast<std::size_t>(hearer - 1)];
  for (const int liar : liars) count[static_cast<std::size_t>(liar - 1)] = 0;
  return count.empty() ? 0 : *std::ranges::max_element(count);
}

void JudgeLiars(const TeamNetwork& network, Budget& budget, Survival& survival) {
  survival.liars_heard = MostHeardLiars(network, survival.liars);
  const auto left = static_cast<std::size_t>(std::ranges::count(network.is_there, true));
  if (left > kMaxRobustness) return;
  budget.Take(left << left);  // it looks at all groups of agents
  survival.robustness = RobustnessOf(GraphOf(network));
  if (survival.robustness) survival.liars_tolerated = std::max(0, (*survival.robustness - 1) / 2);
}

// --- words ----------------------------------------------------------------------------------------------

std::string Joined(const std::vector<std::string>& parts, std::string_view between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : std::string(between)) + part;
  return text;
}

/// "agent 3 is lost", "agents 3 and 4 are lost".
std::string Are(const std::vector<int>& ids, std::string_view one, std::string_view several) {
  return fmt::format("{} {}", AgentList(ids), ids.size() == 1 ? one : several);
}

std::string WrongText(const Survival& survival) {
  std::vector<std::string> parts;
  if (!survival.lost.empty()) parts.push_back(Are(survival.lost, "is lost", "are lost"));
  if (!survival.unheard.empty()) parts.push_back(Are(survival.unheard, "is not heard", "are not heard"));
  if (!survival.deaf.empty()) parts.push_back(Are(survival.deaf, "is deaf", "are deaf"));
  if (!survival.liars.empty()) parts.push_back(Are(survival.liars, "lies", "lie"));
  return parts.empty() ? "no agent is lost, unheard or deaf, and none lies" : Joined(parts, ", ");
}

std::string LeadersText(const std::vector<int>& leaders) {
  return leaders.size() == 1 ? fmt::format("leader {}", leaders.front()) : "any leader";
}

std::string TreeText(const Experiment& now, const TeamNetwork& network, const Survival& survival) {
  const std::vector<int> ids = network.Ids(), leaders = LeadersOf(now);
  const char* const all = survival.lost.empty() ? "all" : "the others";
  if (ids.empty()) return "nobody is left";
  if (!leaders.empty() && std::ranges::none_of(leaders, [&](int id) { return network.Has(id); }))
    return "nobody leads the others";
  if (ids.size() == 1) return fmt::format("{} is alone", AgentList(ids));
  if (*survival.spanning_tree)
    return fmt::format("{} {}{}", all,
                       leaders.size() > 1 ? "hear a leader, directly or not"
                       : leaders.empty()  ? "have a spanning tree"
                                          : fmt::format("have a spanning tree from {}", LeadersText(leaders)),
                       now.schedule.range_m() > 0 ? ", while they are in range" : "");
  if (network.edges == 0) return "nobody hears anybody";
  std::vector<int> whom;
  std::ranges::set_difference(ids, survival.cut_off, std::back_inserter(whom));
  return fmt::format("no spanning tree: {} cut off from {}", Are(survival.cut_off, "is", "are"),
                     leaders.empty() ? AgentList(whom) : LeadersText(leaders));
}

std::string LiarsText(const Experiment& now, const Survival& survival) {
  const std::optional<std::size_t> left_out = LiarsLeftOutBy(now.law);
  const int heard = survival.liars_heard;
  if (heard == 0) return "nobody who tells the truth hears it";
  if (left_out && std::cmp_greater(heard, *left_out))
    return fmt::format("law {} leaves out {} of those that lie, and an agent hears {}", now.law.name, *left_out, heard);
  if (!survival.robustness)
    return fmt::format("the robustness of the graph is not computed beyond {} agents", kMaxRobustness);
  const std::string graph = fmt::format("the graph is {}-robust", *survival.robustness);
  if (left_out) {
    const std::size_t enough = 2 * *left_out + 1;  // what the law is set to, however many lie
    return std::cmp_greater_equal(*survival.robustness, enough)
               ? graph + ", so that those who tell the truth agree"
               : fmt::format("{}; those who tell the truth surely agree from {} on", graph, enough);
  }
  const int tolerated = *survival.liars_tolerated;
  return fmt::format("law {} leaves nothing out; {}, with which W-MSR would tolerate {}{}", now.law.name, graph,
                     tolerated == 0 ? "none" : std::to_string(tolerated),
                     heard > tolerated ? fmt::format(", and an agent hears {}", heard) : "");
}

// --- one moment -----------------------------------------------------------------------------------------

/// Whether the law of an agent would be on at this time if the agent were not lost.
bool WouldBeOn(const AgentConfig& agent, double t_s) {
  constexpr double kRounding_s = 1e-9;  // times are ticks divided by the rate
  return t_s >= agent.start_s - kRounding_s && t_s < agent.stop_s - kRounding_s;
}

/// As it is at this tick of an experiment that events have changed to `now`, whose schedule does not repeat.
Survival SurvivalAt(const Experiment& now, std::int64_t tick, Budget& budget) {
  const double t_s = now.time_s(tick);
  Survival survival;
  survival.from = tick;
  std::vector<bool> is_there;
  for (const AgentConfig& agent : now.agents) {
    is_there.push_back(IsOn(agent, t_s));
    if (agent.faults.is_lost() && WouldBeOn(agent, t_s)) survival.lost.push_back(agent.id);
    if (!is_there.back()) continue;
    if (IsHeardByNobody(agent)) survival.unheard.push_back(agent.id);
    if (agent.faults.is_deaf) survival.deaf.push_back(agent.id);
    if (IsFalseToOthers(agent, t_s)) survival.liars.push_back(agent.id);
  }
  survival.words = WrongText(survival);
  budget.Take(now.agents.size());
  if (!survival.IsAnythingWrong()) return survival;
  survival.ends_run = !LossThatEndsTheRun(now).empty();
  std::vector<std::string> follows;
  if (survival.ends_run) {
    follows.emplace_back("the run ends (run.on_agent_loss = \"abort\")");
  } else if (NeedsTree(now)) {
    const Graph& graph = now.schedule.At(t_s);
    budget.Take(graph.edges());
    if (budget.is_spent()) return survival;
    const TeamNetwork network = NetworkOf(now, graph, std::move(is_there));
    const std::vector<int> leaders = LeadersOf(now);
    survival.cut_off = leaders.empty() ? CutOff(network, budget) : NotReachedFrom(leaders, network, 0, budget);
    if (std::ranges::count(network.is_there, true) > 0) survival.spanning_tree = survival.cut_off.empty();
    const bool only_lies = survival.lost.empty() && survival.unheard.empty() && survival.deaf.empty();
    if (!only_lies || !survival.cut_off.empty()) follows.push_back(TreeText(now, network, survival));
    if (!survival.liars.empty()) {
      JudgeLiars(network, budget, survival);
      follows.push_back(LiarsText(now, survival));
    }
  }
  if (!follows.empty()) survival.words += ": " + Joined(follows, "; ");
  return survival;
}

bool IsSame(const Survival& a, const Survival& b) {
  const auto facts = [](const Survival& survival) {  // all else follows from them and is in the words
    return std::tie(survival.lost, survival.unheard, survival.deaf, survival.liars, survival.cut_off, survival.words);
  };
  return facts(a) == facts(b);
}

/// Adds `next`, if it says something else than the one before; the first must say that something is wrong.
void AddIfNew(Survival next, std::vector<Survival>& moments) {
  const bool is_new = moments.empty() ? next.IsAnythingWrong() : !IsSame(moments.back(), next);
  if (is_new) moments.push_back(std::move(next));
}

/// Ticks of the file's own times at which it may change who is there, lies or is heard, and tick 0.
std::set<std::int64_t> TicksOfTheFile(const Experiment& experiment) {
  std::set<std::int64_t> ticks = {0};
  const auto add = [&](double time_s) {
    if (time_s <= experiment.run.duration_s) ticks.insert(TicksRoundedUp(time_s, experiment.control.rate_hz));
  };
  for (const AgentConfig& agent : experiment.agents) {
    add(agent.start_s);
    add(agent.stop_s);
    if (agent.lie) add(agent.lie->from_s);
  }
  if (experiment.schedule.repeat_s() > 0) return ticks;
  for (const Schedule::Phase& phase : experiment.schedule.phases()) add(phase.at_s);
  return ticks;
}

/// The experiment with a schedule that repeats replaced by the union of its graphs.
Experiment WithUnion(Experiment experiment) {
  if (experiment.schedule.repeat_s() > 0)
    experiment.schedule = Schedule({{0, experiment.schedule.Union()}}, 0, experiment.schedule.range_m());
  return experiment;
}

bool MayGoWrong(const Experiment& experiment) {
  return std::ranges::any_of(experiment.events, [](const Event& event) { return event.fault.has_value(); }) ||
         std::ranges::any_of(experiment.agents, [](const AgentConfig& agent) { return agent.lie.has_value(); });
}

}  // namespace

std::vector<Survival> SurvivalsOf(const Experiment& now) {
  constexpr std::int64_t kMaxWork = kMaxSurvivalWork / 10;  // a run may wait for it
  std::vector<Survival> moments;
  if (std::ranges::none_of(now.agents, [](const AgentConfig& agent) {
        return agent.lie || agent.faults.is_lost() || agent.faults.is_mute || agent.faults.is_deaf ||
               !agent.faults.parts.empty();
      }))
    return moments;
  const Experiment joined = WithUnion(now);
  Budget budget(kMaxWork);
  for (const std::int64_t tick : TicksOfTheFile(joined)) {
    if (budget.is_spent()) break;
    AddIfNew(SurvivalAt(joined, tick, budget), moments);
  }
  return moments;
}

SurvivalOfRun SurvivalOf(const Experiment& experiment) {
  SurvivalOfRun survival;
  if (!MayGoWrong(experiment)) return survival;
  const SuppressedLawOutput suppressed;
  Budget budget(kMaxSurvivalWork);
  LiveExperiment live(WithUnion(experiment), &LawTable(), /*checked=*/true);
  std::set<std::int64_t> ticks = TicksOfTheFile(experiment);
  for (const Event& event : experiment.events) ticks.insert(event.tick);
  auto event = experiment.events.begin();
  while (!ticks.empty()) {
    const std::int64_t tick = *ticks.begin();
    ticks.erase(ticks.begin());
    for (; event != experiment.events.end() && event->tick == tick; ++event) live.Take(*event);
    for (const Event& restart : live.RestartsAt(tick)) live.Take(restart);
    if (const auto restart = live.NextRestart(); restart && *restart <= experiment.ticks()) ticks.insert(*restart);
    Survival next = SurvivalAt(live.current(), tick, budget);
    if (budget.is_spent()) {
      survival.unknown_from = tick;
      break;
    }
    AddIfNew(std::move(next), survival.moments);
    if (!survival.moments.empty() && survival.moments.back().ends_run) break;
  }
  return survival;
}

}  // namespace mascot
