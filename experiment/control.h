#pragma once

#include <span>

#include "experiment/experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// The keys of [control], and those of an agent's own control table.
std::span<const Key> ControlKeys();
std::span<const Key> AgentControlKeys();
/// Reads from `control` what may differ from agent to agent (all but rate_hz) into `agents`: their ControlConfig, and
/// the gains and limits that replace those of their airframes.
void ReadControl(Section& control, std::span<AgentConfig> agents);

}  // namespace mascot
