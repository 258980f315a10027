#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace CLI {
class App;
}

namespace mascot {

/// The override that the user means by `--set KEY=VALUE`. Throws ConfigError.
Override ParseOverride(const std::string& set);

/// CONFIG [--set key=value]... [--duration-s S] [--seed N]: the arguments of every verb that reads one experiment.
struct ConfigArgs {
  std::string path;
  std::vector<std::string> sets;                ///< as typed
  std::optional<std::string> duration_s, seed;  ///< take precedence over `sets`

  /// Declares the arguments. `*this` must outlive the parsing.
  void AddTo(CLI::App& command);
  /// Reads and checks the experiment. A copy of these arguments does not read the file again, which may be a pipe.
  /// Throws ConfigError.
  Experiment Load(UserCode user_code = UserCode::kMayRun);

  /// The text of the experiment, as Load() reads it, and what the arguments change in it. Throws ConfigError.
  const std::string& Text();
  std::string Name() const;  ///< of the file, for messages
  std::vector<Override> Overrides() const;

 private:
  std::optional<std::string> text_;
};

}  // namespace mascot
