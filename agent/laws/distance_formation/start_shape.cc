#include "agent/laws/distance_formation/start_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "base/linear_algebra.h"

namespace mascot {
namespace {

/// The dimension of the smallest flat that holds all points: 0 for one place, 1 for a line, 2 for a plane.
int FlatnessOf(std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::Vector3d centre = CentroidOf(points);
  double farthest_m = 0;
  for (const Eigen::Vector3d& p : points) farthest_m = std::max(farthest_m, Along(axes, p).norm());
  Eigen::MatrixXd ways(3, std::ssize(points));
  for (Eigen::Index i = 0; i < ways.cols(); ++i)
    ways.col(i) = Along(axes, points[static_cast<std::size_t>(i)] - centre);
  constexpr double kRounding = 1e-12;
  return ways.colwise().norm().maxCoeff() <= kRounding * farthest_m ? 0 : RankOf(ways);
}

/// What agent `id` hears, but for `other`: weight and distance of the places, by the neighbour's id.
std::map<int, std::pair<double, double>> HeardBut(int id, int other, std::span<const Bar> bars,
                                                  std::span<const Eigen::Vector3d> places_W, Axes axes) {
  std::map<int, std::pair<double, double>> heard;
  for (const Bar& bar : bars) {
    if (bar.i != id && bar.j != id) continue;
    const int neighbour = bar.i == id ? bar.j : bar.i;
    if (neighbour != other) heard[neighbour] = {bar.weight, LengthOf(bar, places_W, axes)};
  }
  return heard;
}

}  // namespace

std::vector<std::string> FlatStartWarnings(std::span<const Eigen::Vector3d> starts_W,
                                           std::span<const Eigen::Vector3d> places_W, Axes axes) {
  const int flatness = FlatnessOf(starts_W, axes);
  if (flatness >= FlatnessOf(places_W, axes)) return {};
  constexpr std::array<std::string_view, 3> kWhere = {"at one place", "on a line", "in a plane"};
  constexpr std::array<std::string_view, 3> kNot = {"at one", "on one", "in one"};
  const auto n = static_cast<std::size_t>(flatness);
  return {
      fmt::format("agents.position_m: all agents start {}, which the law does not leave without a disturbance, and "
                  "their places in the formation are not {}",
                  kWhere[n], kNot[n])};
}

std::vector<std::string> TwinWarnings(std::span<const Bar> bars, std::span<const Eigen::Vector3d> starts_W,
                                      std::span<const Eigen::Vector3d> places_W, Axes axes) {
  const auto same = [](const auto& a, const auto& b) {
    constexpr double kRounding = 1e-12;
    const auto& [weight_a, length_a] = a.second;
    const auto& [weight_b, length_b] = b.second;
    return a.first == b.first && weight_a == weight_b && std::abs(length_a - length_b) <= kRounding * length_a;
  };
  const int agents = static_cast<int>(starts_W.size());
  for (int i = 1; i <= agents; ++i)
    for (int j = i + 1; j <= agents; ++j) {
      const Bar pair{i, j};
      if (LengthOf(pair, starts_W, axes) > 0 || LengthOf(pair, places_W, axes) == 0) continue;
      if (std::ranges::equal(HeardBut(i, j, bars, places_W, axes), HeardBut(j, i, bars, places_W, axes), same))
        return {
            fmt::format("agents.position_m: agents {} and {} start at one place, and do not part without a "
                        "disturbance: their places are at the same distances from the same neighbours",
                        i, j)};
    }
  return {};
}

}  // namespace mascot
