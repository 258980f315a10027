#include "agent/laws/coverage/coverage_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

/// Notes in `section` bumps that are too narrow for what numbers resolve, or too far away to matter.
void CheckBumps(const CoverageParams& params, Section& section) {
  constexpr double kNarrowest = 1e-6, kFarthest = 37;  // e^-(37^2 / 2) is about the smallest number
  for (std::size_t n = 0; n < params.bumps.size(); ++n) {
    double farthest_m = 0;
    for (const Eigen::Vector2d& corner : params.region)
      farthest_m = std::max(farthest_m, (corner - params.bumps[n].centre_m).norm());
    if (params.bumps[n].width_m < kNarrowest * farthest_m)
      section.FailRow(
          "density", n,
          fmt::format("expected a width of at least {:.3g}, a millionth of the distance from the bump to the "
                      "farthest corner of the region, got {}",
                      kNarrowest * farthest_m, ShortestFloat(params.bumps[n].width_m)));
  }
  if (!params.bumps.empty() && !section.Wrong("density") &&
      std::ranges::none_of(params.bumps,
                           [&](const GaussianBump& bump) { return DistanceInWidths(params.region, bump) < kFarthest; }))
    section.Fail("density",
                 fmt::format("expected a bump less than {} widths away from the region, got none: all of the "
                             "region would count for nothing",
                             kFarthest));
}

}  // namespace

std::shared_ptr<const LawParams> ReadCoverage(const Experiment& /*experiment*/, const LawConfig& law,
                                              Section& section) {
  ExpectNoLeader(law, section);
  auto params = std::make_shared<CoverageParams>();
  const auto rows = [&section](const char* key, std::size_t size, const char* what) {
    const std::vector<std::vector<double>> read = section.Rows(key);
    for (std::size_t n = 0; n < read.size(); ++n)
      if (read[n].size() != size) section.FailRow(key, n, what);
    return section.Wrong(key) ? std::vector<std::vector<double>>() : read;
  };
  for (const auto& row : rows("region_m", 2, "expected a corner [x, y], got another number of values"))
    params->region.emplace_back(row[0], row[1]);
  if (!section.Wrong("region_m") && !IsConvex(params->region))
    section.Fail("region_m", "expected the corners of a convex region, counterclockwise, got others");
  for (const auto& row : rows("density", 4, "expected [x, y, width, weight], got another number of values")) {
    params->bumps.push_back({.centre_m = {row[0], row[1]}, .width_m = row[2], .weight = row[3]});
    if (row[2] <= 0 || row[3] <= 0) section.Fail("density", "expected widths and weights above 0, got others");
  }
  if (!section.Wrong("density") && !section.Wrong("region_m")) CheckBumps(*params, section);
  params->gain = section.Number("gain");
  return params;
}

Polygon CellOf(const CoverageParams& params, int id, std::span<const int> ids, std::span<const Eigen::Vector3d> p_W) {
  const auto place = [&](int of) -> Eigen::Vector2d { return p_W[static_cast<std::size_t>(of - 1)].head<2>(); };
  Polygon cell = params.region;
  for (const int other : ids) {
    if (other < id && place(other) == place(id)) return {};
    if (other != id) cell = Nearer(cell, place(id), place(other));
  }
  return cell;
}

double CoverageCost(const CoverageParams& params, std::span<const int> ids, std::span<const Eigen::Vector3d> p_W) {
  const Moments all = params.Of(params.region, params.region[0]);
  double cost = 0;
  for (const int id : ids) {
    const Moments moments = params.Of(CellOf(params, id, ids, p_W), p_W[static_cast<std::size_t>(id - 1)].head<2>());
    cost += moments.second * std::exp(moments.log_unit - all.log_unit);
  }
  return cost / all.mass;
}

}  // namespace mascot
