#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace CLI {
class App;
}

namespace mascot {

/// CONFIG [--set key=value]...: how every verb that reads an experiment is told which one.
struct ConfigArgs {
  std::string path;
  std::vector<std::string> sets;    ///< as typed
  std::vector<Override> overrides;  ///< a verb's own, from options such as --seed; they win over `sets`

  /// Declares the arguments. `*this` must outlive the parsing.
  void AddTo(CLI::App& command);
  /// Reads and checks everything. Throws ConfigError.
  Experiment Load() const;
};

}  // namespace mascot
