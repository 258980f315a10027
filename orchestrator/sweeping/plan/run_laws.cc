#include "orchestrator/sweeping/plan/run_laws.h"

#include <algorithm>
#include <memory>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "experiment/phase.h"
#include "orchestrator/sweeping/plan/law_axis.h"

namespace mascot {
namespace {

/// The experiment as its last phase flies it.
std::shared_ptr<const Experiment> AtTheEnd(const Experiment& start) {
  if (PhasesOf(start).empty()) return std::make_shared<const Experiment>(start);
  LiveExperiment live(start, &LawTable(), /*checked=*/true);
  for (const Event& event : start.events) live.Take(event);
  return live.now();
}

/// The value of law.name in a run; empty: the sweep does not set it.
std::string LawNameOf(const SweepPoint& point) {
  const auto name = std::ranges::find(point.overrides, kLawKey, &Override::key);
  return name == point.overrides.end() ? "" : Unquoted(name->value);
}

}  // namespace

RunLaws LawsAtTheEnd(const Experiment& experiment) {
  const auto end = AtTheEnd(experiment);
  RunLaws laws{.team = end->law.name, .team_agrees = EntryOf(end->law).agrees, .names = {}};
  for (const LawEntry* law : LawsIn(*end)) laws.names.emplace_back(law->name);
  laws.depend_on_numbers = laws.names.size() > 1 || !PhasesOf(experiment).empty() || !experiment.late_phases_s.empty();
  return laws;
}

SweepLaws::SweepLaws(const SweepPlan& plan, const KnownLaws& known)
    : plan_(plan), known_(known), representatives_(plan.RepresentativesOf(known.alike)) {}

const RunLaws* SweepLaws::Of(std::size_t run) const {
  const auto laws = known_.of_run.find(representatives_[run]);
  return laws == known_.of_run.end() ? nullptr : &laws->second;
}

bool SweepLaws::Has(std::size_t run, std::string_view law) const {
  if (const RunLaws* laws = Of(run)) return std::ranges::find(laws->names, law) != laws->names.end();
  const std::string name = LawNameOf(plan_[run]);
  return name.empty() || name == law;
}

std::set<std::string> SweepLaws::AllNames() const {
  std::set<std::string> names;
  for (const auto& [run, laws] : known_.of_run) names.insert(laws.names.begin(), laws.names.end());
  return names;
}

}  // namespace mascot
