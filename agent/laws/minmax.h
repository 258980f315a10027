#pragma once

#include <optional>
#include <vector>

#include "agent/laws/waypoint.h"
#include "experiment/experiment.h"

namespace mascot {

inline constexpr std::string_view kWeakEdges[] = {"refuse", "root"};

inline constexpr auto kMinmaxParameters = Joined(
    std::array{
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
        key::Number("boundary_layer", {0, 1000},
                    "distance to the parent within which sgn gives way to a smooth function")
            .Default("0.0")
            .Unit("m")
            .Live(),
    },
    kLeaderFlightParameters);

}  // namespace mascot
