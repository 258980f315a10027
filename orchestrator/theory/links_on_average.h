#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiment/experiment.h"

namespace mascot {

/// The fraction of samples that a link delivers in the long run (for bursts: in the stationary state).
double Delivered(const LinkConfig& link);
/// `graph` on average: each weight times the fraction that its link delivers, without the edges that deliver nothing.
Graph OnAverage(const Graph& graph, const LinkTable& links);
/// Whether some link loses some of its samples, but not all.
bool LosesSome(const Experiment& experiment);
/// The least fraction of samples that a link delivers which loses some of them and holds none in their place
/// (link.hold_s below one tick); 1 if there is no such link.
double MinDeliveredUnheld(const Experiment& experiment);
/// The delay, without jitter, of the link on which `hearer` hears `heard`, in ticks.
std::int64_t DelayTicks(const Experiment& experiment, int hearer, int heard);
/// The delay of agents' own position and velocity, in ticks.
std::int64_t OwnDelayTicks(const Experiment& experiment);
/// The longest delay, without jitter, of own states and of links that deliver something, in ticks.
std::int64_t LongestDelayTicks(const Experiment& experiment);
/// The delay, without jitter, that all edges of `graph` have in common, in ticks; nothing if delays differ.
std::optional<std::int64_t> CommonDelayTicks(const Experiment& experiment, const Graph& graph);
/// The longest delay, with jitter, that a sample may have on any edge (s).
double LongestDelay(const Experiment& experiment);
/// Why the age of received samples is random, naming the key; empty: it is not.
std::string RandomAge(const Experiment& experiment);

}  // namespace mascot
