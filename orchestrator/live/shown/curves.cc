#include "orchestrator/live/shown/curves.h"

#include <algorithm>
#include <utility>

namespace mascot {
namespace {

std::vector<double> SpeedsOf(std::span<const Motion> motions) {
  std::vector<double> speeds;
  for (const Motion& motion : motions) speeds.push_back(motion.v_WB.norm());
  if (std::ssize(speeds) <= Curves::kMaxSpeeds) return speeds;
  const auto [slowest, fastest] = std::ranges::minmax(speeds);
  double sum = 0;
  for (const double speed : speeds) sum += speed;
  return {fastest, sum / static_cast<double>(speeds.size()), slowest};
}

}  // namespace

void Curves::Add(std::int64_t tick, double disagreement_m, std::optional<double> of_law,
                 std::span<const Motion> motions) {
  if (!Wants(tick)) return;
  points_.push_back({tick, disagreement_m, of_law, SpeedsOf(motions)});
  if (points_.size() < kMaxPoints) return;
  every_ *= 2;
  std::erase_if(points_, [this](const Point& point) { return point.tick % every_ != 0; });
}

}  // namespace mascot
