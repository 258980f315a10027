#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiment/experiment.h"

namespace mascot {

/// The part of samples that a link delivers, in the long run.
double Delivered(const LinkConfig& link);
/// `graph` as it is on average: each weight times what the link delivers, without the edges that deliver nothing.
Graph OnAverage(const Graph& graph, const LinkTable& links);
/// Whether samples are lost on some edge, but not all of them.
bool LosesSome(const Experiment& experiment);
/// The delay of the link on which `hearer` hears `heard`, as it arrives in ticks; jitter aside.
std::int64_t DelayTicks(const Experiment& experiment, int hearer, int heard);
/// The delay that all edges of `graph` have, as it arrives in ticks; nothing if it differs. Jitter aside.
std::optional<std::int64_t> CommonDelayTicks(const Experiment& experiment, const Graph& graph);
/// The longest delay that a sample may have on any edge (s).
double LongestDelay(const Experiment& experiment);
/// Why the age of what is heard is random, naming the key; empty: it is not.
std::string RandomAge(const Experiment& experiment);

}  // namespace mascot
