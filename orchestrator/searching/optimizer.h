#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "orchestrator/sweeping/plan/plan.h"
#include "system/child_process.h"
#include "system/descriptor.h"
#include "system/line_pipe.h"
#include "system/stop_signal.h"

namespace mascot {

/// A key whose values a search chooses.
struct SearchedKey {
  KeyRange range;                         ///< of numbers; only the key counts if there are choices
  std::vector<std::string> choices = {};  ///< one of these values, as PlainValue() (plan/values.h) has them
};

/// The values of the searched keys, in their order, each as PlainValue() has it.
using Candidate = std::vector<std::string>;

/// Proposes candidates: Optuna's tree-structured Parzen estimator (Bergstra et al. 2011), in a Python process,
/// scripts/optimizer.py. The same questions get the same answers. What is asked and told throws Interrupted
/// (sweeping/sweep_checks.h) if a signal comes, and std::runtime_error if the process has ended.
class Optimizer {
 public:
  struct Setting {
    std::uint64_t seed = 0;
    bool maximize = false;
    std::optional<Candidate> first = {};  ///< the candidate to begin with
  };

  /// `stop` must outlive this object.
  Optimizer(const std::vector<SearchedKey>& keys, const Setting& setting, StopSignal& stop);

  /// What proposes: "optuna 3.1.0".
  const std::string& name() const { return name_; }
  std::vector<Candidate> Ask(std::size_t count);
  /// The values of the candidates of the last Ask(), in their order; nothing is worse than any number.
  void Tell(std::span<const std::optional<double>> values);

 private:
  nlohmann::json Answer(const nlohmann::json& said);

  const std::vector<SearchedKey> keys_;
  StopSignal& stop_;
  Descriptor input_, output_;
  ChildProcess process_;
  std::unique_ptr<LineReader> lines_;
  std::string name_;
};

}  // namespace mascot
