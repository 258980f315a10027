#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bus/bus.h"
#include "experiment/experiment.h"

namespace mascot {

/// What somebody outside wants of agent `id` at this tick has come.
using OnAction = std::function<void(int id, std::int64_t tick, std::span<const double> action)>;

/// A reader for each of these agents that takes actions (AgentConfig::takes_actions).
std::vector<std::unique_ptr<ReaderBase>> ActionReaders(Domain& domain, const Experiment& experiment, AgentRange agents,
                                                       const OnAction& on_action);

}  // namespace mascot
