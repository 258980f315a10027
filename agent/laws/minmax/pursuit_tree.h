#pragma once

#include <array>

#include "agent/laws/laws.h"

namespace mascot {

// Pursuit on a spanning tree of the graph: its keys, and how they become a tree with a bound for each agent.

inline constexpr std::string_view kWeakEdges[] = {"refuse", "root"};

inline constexpr std::array kPursuitTreeParameters = {
    key::Integer("leader", 1, kMaxAgents, "root of the spanning tree, 1..N").Required(),
    key::Number("beta", Above(0, 1000), "largest acceleration per axis: one number, or a list by id")
        .Or(ValueKind::kNumbers)
        .Unit("m/s^2")
        .Required()
        .Live(),
    key::OneOf("weak_edges", kWeakEdges,
               "an edge whose child is not stronger than its parent: refuse, or expect the root's bound of every "
               "parent")
        .Default("\"refuse\""),
};

/// Reads these keys. Mistakes are noted in `section`: a root that some agents do not hear, with their numbers; an edge
/// whose child is not stronger than its parent.
PursuitForm ReadPursuitTree(const Experiment& experiment, const LawConfig& law, Section& section);

}  // namespace mascot
