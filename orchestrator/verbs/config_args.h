#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace CLI {
class App;
}

namespace mascot {

/// CONFIG [--set key=value]... [--duration-s S] [--seed N]: how every verb that reads an experiment is told which one.
struct ConfigArgs {
  std::string path;
  std::vector<std::string> sets;                ///< as typed
  std::optional<std::string> duration_s, seed;  ///< they win over `sets`

  /// Declares the arguments. `*this` must outlive the parsing.
  void AddTo(CLI::App& command);
  /// Reads and checks everything. Throws ConfigError.
  Experiment Load() const;
};

}  // namespace mascot
