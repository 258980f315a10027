#pragma once

#include <span>

#include "experiment/experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// The keys of [control], and those that an agent may have different.
std::span<const Key> ControlKeys();
std::span<const Key> AgentControlKeys();
/// Reads all of `control` that may differ from agent to agent, into `agents`: their ControlConfig, and what stands in
/// place of their airframes' gains and limits.
void ReadControl(Section& control, std::span<AgentConfig> agents);

}  // namespace mascot
