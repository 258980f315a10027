#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

inline constexpr std::string_view kFormationShapes[] = {"circle", "line", "grid", "vee"};

/// The keys of the places d_i of a formation whose scale does not matter.
inline constexpr std::array kPlaceKeysWithoutScale = {
    key::Points("offsets_m", {-1e6, 1e6}, "d_i: each agent's place, relative to a point that all agents share").Live(),
    key::OneOf("shape", kFormationShapes, "places of a family, instead of offsets_m; in x and y"),
};
/// The keys of the places d_i of a formation, in laws that have one.
inline constexpr auto kPlaceKeys =
    Joined(kPlaceKeysWithoutScale,
           std::array{
               key::Number("spacing_m", Above(0, 1e4), "with shape: between neighbouring places").Default("2.0").Live(),
           });

/// Whether places are read with kPlaceKeys or with kPlaceKeysWithoutScale, where neighbouring places are 1 m apart.
enum class PlaceScale { kRead, kNone };
/// Reads these keys: the place of each of `agents` agents, in W (m). Mistakes are noted in `law`.
std::vector<Eigen::Vector3d> ReadPlaces(Section& law, int agents, PlaceScale scale = PlaceScale::kRead);

}  // namespace mascot
