#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "agent/law.h"
#include "experiment/experiment.h"

namespace mascot {

/// A row of the table of laws. `orchestrator laws` prints these.
struct LawEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view equation;
  std::string_view theory;          ///< what is known about it
  std::string_view source;          ///< paper
  std::span<const Key> parameters;  ///< its keys of [law], besides those that all laws have
  Axes axes;                        ///< default of law.axes
  /// Reads and checks the parameters of all agents that share `law`, a law of this name, from law.section. Returns
  /// whether it sends messages.
  bool (*read)(Experiment& experiment, LawConfig& law);
  /// Makes the law of agent `id`, which is of this name.
  std::unique_ptr<Law> (*make)(Experiment& experiment, int id);
};

std::span<const LawEntry> Laws();
std::span<const std::string_view> LawNames();
/// The law of agent `id`. Mistakes in its parameters are noted in the experiment's document.
std::unique_ptr<Law> MakeLaw(Experiment& experiment, int id);

/// Reads a complete experiment: ReadExperiment, then the laws' parameters, then Finish. What `check`,
/// `up`, the server and the agents all call. `checked`: it was read before, without a mistake. Throws ConfigError.
Experiment LoadExperiment(Section document, const std::string& default_name, bool checked = false);

}  // namespace mascot
