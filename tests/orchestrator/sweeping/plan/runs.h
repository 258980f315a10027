#pragma once

#include <string>
#include <vector>

#include "orchestrator/sweeping/plan/plan.h"

namespace mascot {

/// The runs of a plan, each as "value value ...".
inline std::vector<std::string> Runs(const SweepPlan& plan) {
  std::vector<std::string> runs;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    std::string run;
    for (const Override& override : plan[i].overrides) run += (run.empty() ? "" : " ") + override.value;
    runs.push_back(run);
  }
  return runs;
}

}  // namespace mascot
