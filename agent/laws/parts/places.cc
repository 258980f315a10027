#include "agent/laws/parts/places.h"

#include <cmath>
#include <numbers>
#include <string>

#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

/// Place `i`, from 0, of `count` places in a shape; neighbouring places are one unit apart.
Eigen::Vector3d PlaceOf(std::string_view shape, int i, int count) {
  if (shape == "line") return {static_cast<double>(i), 0, 0};
  if (shape == "vee") {  // agent 1 at the tip, ranks behind it to both sides
    const int rank = (i + 1) / 2;
    const double side = std::numbers::sqrt2 / 2 * rank;
    return {-side, i % 2 == 1 ? side : -side, 0};
  }
  if (shape == "grid") {
    const int width = static_cast<int>(std::ceil(std::sqrt(count)));
    const int row = i / width, column = i % width;
    return {static_cast<double>(column), static_cast<double>(row), 0};
  }
  const double angle = 2 * std::numbers::pi * i / count;
  const double radius = count > 1 ? 0.5 / std::sin(std::numbers::pi / count) : 0;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

}  // namespace

std::vector<Eigen::Vector3d> ReadPlaces(Section& law, int agents, PlaceScale scale) {
  const auto count = static_cast<std::size_t>(agents);
  law.Supersede("offsets_m", {"shape", "spacing_m"});
  law.Supersede("shape", {"offsets_m"});
  if (!HasOneOf(law, "offsets_m", "shape", "shape"))
    return std::vector<Eigen::Vector3d>(count, Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> places;
  if (law.Has("shape")) {
    const std::string shape = law.OneOf("shape");
    const double spacing_m = scale == PlaceScale::kRead ? law.Number("spacing_m") : 1;
    for (int i = 0; i < agents; ++i) places.push_back(spacing_m * PlaceOf(shape, i, agents));
    return places;
  }
  places = law.Points("offsets_m");
  if (!law.Wrong("offsets_m") && places.size() != count)
    law.Fail("offsets_m", "expected " + std::to_string(count) + " points, one per agent, got a list of " +
                              std::to_string(places.size()));
  places.resize(count, Eigen::Vector3d::Zero());
  return places;
}

}  // namespace mascot
