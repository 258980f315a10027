#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/raw_rows.h"
#include "orchestrator/team/action_source.h"

namespace mascot {

/// Gives the agents of a run the actions that a recording has.
class RecordedActions final : public ActionSource {
 public:
  /// `plan` is that of the recording. Throws ConfigError if it has not the actions of every tick of all agents that
  /// take some.
  RecordedActions(const std::string& recording, const RecordingPlan& plan, const Experiment& experiment);

  std::span<const std::vector<double>> At(std::int64_t tick) override;

 private:
  const std::string recording_;
  RawRows rows_;
  const Row* row_ = nullptr;  // the newest
  std::vector<std::vector<double>> actions_;
};

}  // namespace mascot
