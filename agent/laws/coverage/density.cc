// Integrals of a Gaussian bump over a convex polygon, in units of its width. x points from the centre of the bump to
// the point q0 of the polygon that is nearest to it, at the distance d; the origin is q0. The density there is e^(-d^2
// / 2), which goes into the unit; what is left of it is e^(-x (x / 2 + d)) e^(-y^2 / 2), at most 1. The polygon is cut
// to where that is above e^-41, and into slabs between the x of its corners. The integrals over y are closed forms, or
// sums over points where the slab is low; those over x are sums over points. No term of the mass or of the second
// moment is negative, so that nothing cancels.
#include "agent/laws/coverage/density.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "agent/laws/coverage/gaussian.h"

namespace mascot {
namespace {

constexpr double kSightWidths = 9;  // e^-(kSightWidths^2 / 2) is nothing

/// A bump as seen from the point of a polygon that is nearest to it.
struct BumpFrame {
  BumpFrame(const Polygon& polygon, const GaussianBump& bump)
      : q0(NearestPoint(polygon, bump.centre_m)), width_m(bump.width_m) {
    const Eigen::Vector2d way = q0 - bump.centre_m;
    distance = way.norm() / width_m;
    if (distance > 0) x = way.normalized();
  }
  Eigen::Vector2d Of(const Eigen::Vector2d& q) const { return {x.dot(q - q0) / width_m, Cross(x, q - q0) / width_m}; }

  Eigen::Vector2d q0;
  Eigen::Vector2d x = Eigen::Vector2d::UnitX();
  double width_m, distance;
};

/// What of the polygon counts, in that frame.
Polygon PartThatCounts(const Polygon& polygon, const BumpFrame& frame) {
  Polygon seen;
  for (const Eigen::Vector2d& q : polygon) seen.push_back(frame.Of(q));
  const double d = frame.distance,
               depth = kSightWidths * kSightWidths / (std::sqrt(d * d + kSightWidths * kSightWidths) + d);
  seen = Within(seen, {depth, 0}, {1, 0});
  seen = Within(seen, {-kSightWidths, 0}, {-1, 0});
  seen = Within(seen, {0, kSightWidths}, {0, 1});
  return Within(seen, {0, -kSightWidths}, {0, -1});
}

/// An edge of a slab: its y at both ends.
struct SlabEdge {
  double from, to;
  double At(double share) const { return from + share * (to - from); }
};

/// The lower and the upper edge of a polygon between two neighbouring x of its corners.
std::pair<SlabEdge, SlabEdge> EdgesBetween(const Polygon& polygon, double from, double to) {
  std::pair<SlabEdge, SlabEdge> edges{{0, 0}, {0, 0}};
  bool none = true;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (std::min(a.x(), b.x()) > from || std::max(a.x(), b.x()) < to) continue;
    const auto y = [&](double x) { return a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y()); };
    const SlabEdge line{y(from), y(to)};
    if (none || line.At(0.5) < edges.first.At(0.5)) edges.first = line;
    if (none || line.At(0.5) > edges.second.At(0.5)) edges.second = line;
    none = false;
  }
  return edges;
}

Moments MomentsOfBump(const Polygon& polygon, const Eigen::Vector2d& o, const GaussianBump& bump) {
  const BumpFrame frame(polygon, bump);
  const Polygon seen = PartThatCounts(polygon, frame);
  const Eigen::Vector2d about = frame.Of(o);
  const double d = frame.distance;
  std::vector<double> corners;
  for (const Eigen::Vector2d& q : seen) corners.push_back(q.x());
  std::ranges::sort(corners);
  Moments sum;
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const double from = corners[k - 1], to = corners[k];
    if (!(to > from)) continue;
    const auto [lower, upper] = EdgesBetween(seen, from, to);
    // Along x the density falls the faster, the farther away the bump is.
    const double length = std::max({(to - from) * (1 + d / 3), std::hypot(to - from, lower.to - lower.from),
                                    std::hypot(to - from, upper.to - upper.from)});
    const double panels = std::max(1.0, std::ceil(length / kLongestPanel));
    for (std::int64_t panel = 0; panel < static_cast<std::int64_t>(panels); ++panel)
      ForEachGaussPoint(
          GaussRuleFor(length / panels), static_cast<double>(panel) / panels, static_cast<double>(panel + 1) / panels,
          [&, &low_edge = lower, &high_edge = upper](double share, double weight) {
            const double x = from + share * (to - from), low = low_edge.At(share), high = high_edge.At(share);
            if (!(high > low)) return;
            const double part = weight * (to - from) * std::exp(-x * (x / 2 + d));
            const auto [y0, y1, y2] = GaussMoments(low, high, about.y());
            sum.mass += part * y0;
            sum.first += part * Eigen::Vector2d((x - about.x()) * y0, y1);
            sum.second += part * ((x - about.x()) * (x - about.x()) * y0 + y2);
          });
  }
  const double s = bump.width_m;
  const Eigen::Vector2d y(-frame.x.y(), frame.x.x());
  return {.mass = s * s * sum.mass,
          .first = s * s * s * (sum.first.x() * frame.x + sum.first.y() * y),
          .second = s * s * s * s * sum.second,
          .log_unit = std::log(bump.weight) - d * d / 2};
}

}  // namespace

double DistanceInWidths(const Polygon& polygon, const GaussianBump& bump) { return BumpFrame(polygon, bump).distance; }

Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o, std::span<const GaussianBump> bumps) {
  if (polygon.size() < 3) return {};
  std::vector<Moments> parts;
  for (const GaussianBump& bump : bumps)
    if (Moments part = MomentsOfBump(polygon, o, bump); part.mass > 0) parts.push_back(part);
  if (parts.empty()) return {};
  Moments sum{.log_unit = std::ranges::max(parts, {}, &Moments::log_unit).log_unit};
  for (const Moments& part : parts) {
    const double share = std::exp(part.log_unit - sum.log_unit);
    sum.mass += share * part.mass;
    sum.first += share * part.first;
    sum.second += share * part.second;
  }
  return sum;
}

}  // namespace mascot
