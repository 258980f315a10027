#include "orchestrator/report/survival_report.h"

#include <fmt/format.h>

#include <algorithm>

namespace mascot {

Json SurvivalJson(const Experiment& experiment, const SurvivalOfRun& survival) {
  Json json = Json::array();
  for (const Survival& moment : survival.moments)
    json.push_back({{"from_s", experiment.time_s(moment.from)},
                    {"lost", moment.lost},
                    {"unheard", moment.unheard},
                    {"deaf", moment.deaf},
                    {"liars", moment.liars},
                    {"ends_run", moment.ends_run},
                    {"spanning_tree", OrNull(moment.spanning_tree)},
                    {"cut_off", moment.cut_off},
                    {"robustness", OrNull(moment.robustness)},
                    {"liars_tolerated", OrNull(moment.liars_tolerated)},
                    {"liars_heard", moment.liars_heard}});
  return json;
}

Json LossToleranceJson(const std::optional<LossTolerance>& tolerance) {
  return tolerance && tolerance->is_known ? Json(tolerance->cannot_lose) : Json(nullptr);
}

std::vector<std::pair<std::string, std::string>> SurvivalLines(const Experiment& experiment,
                                                               const SurvivalOfRun& survival) {
  constexpr std::size_t kShown = 20;
  std::vector<std::pair<std::string, std::string>> lines;
  for (const Survival& moment : survival.moments) {
    if (lines.size() == kShown) break;
    lines.emplace_back("faults", fmt::format("from {:g} s {}", experiment.time_s(moment.from), moment.words));
  }
  if (survival.moments.size() > kShown)
    lines.emplace_back("faults",
                       fmt::format("and {} more changes, up to {:g} s: see --json", survival.moments.size() - kShown,
                                   experiment.time_s(survival.moments.back().from)));
  if (survival.unknown_from)
    lines.emplace_back("faults", fmt::format("from {:g} s on not looked at: too many changes for a graph with so many "
                                             "edges",
                                             experiment.time_s(*survival.unknown_from)));
  return lines;
}

}  // namespace mascot
