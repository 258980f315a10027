// A run in this process of agents that are told what to do.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "orchestrator/engines/inprocess.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/run_writer.h"
#include "tests/support/load.h"

namespace mascot {

/// Actions that depend on the tick and the agent.
class Waves final : public ActionSource {
 public:
  explicit Waves(double size) : size_(size) {}
  std::span<const std::vector<double>> At(std::int64_t tick) override {
    for (std::size_t i = 0; i < actions_.size(); ++i)
      actions_[i] = {size_ * std::sin(0.1 * static_cast<double>(tick)), size_ * static_cast<double>(i), 0.0};
    return actions_;
  }

 private:
  const double size_;
  std::vector<std::vector<double>> actions_{2};
};

/// Flies `toml`, an experiment of two agents that take actions, and records it in `run`. Returns the path of the
/// recording.
inline std::string RecordedWithActions(const std::string& toml, const std::string& run) {
  const Experiment experiment = Load(toml);
  const RunFolder folder(run, experiment, false);
  RunWriter writer(experiment, folder, experiment.resolved);
  Waves waves(1);
  EXPECT_EQ(RunInProcess(
                experiment, {&writer}, [] { return true; }, nullptr, Crew::Alone(), [](const std::string&) {}, &waves)
                .failure,
            "");
  writer.Close(experiment.resolved);
  return folder.File("run.mcap").string();
}

}  // namespace mascot
