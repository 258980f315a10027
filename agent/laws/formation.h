#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "agent/laws/consensus.h"
#include "experiment/experiment.h"

namespace mascot {

inline constexpr std::string_view kFormationShapes[] = {"circle", "line", "grid", "vee"};

inline constexpr auto kFormationParameters = Joined(
    std::array{
        key::Points("offsets_m", {-1e6, 1e6}, "d_i: each agent's place, relative to a point that all agents share")
            .Live(),
        key::OneOf("shape", kFormationShapes, "places of a family, instead of offsets_m; in x and y"),
        key::Number("spacing_m", Above(0, 1e4), "with shape: between neighbouring places").Default("2.0").Live(),
        key::Number("p_gain", kGain, "pull towards the place that each neighbour's position means, times its weight")
            .Default("1.0")
            .Unit("1/s^2")
            .Live(),
    },
    kVelocityAndLeaderParameters);

}  // namespace mascot
