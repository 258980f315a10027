#include "orchestrator/live/recorded/edge_history.h"

#include <algorithm>
#include <utility>

namespace mascot {
namespace {

/// Places that are kept: fewer if there are many edges, for each of which a place takes about a kilobyte.
constexpr std::int64_t kMaxPlaces = 60, kMaxEdgesKept = 200'000;

std::int64_t PlacesFor(const Experiment& experiment) {
  const auto edges = static_cast<std::int64_t>(std::max<std::size_t>(experiment.graph.edges(), 1));
  return std::clamp<std::int64_t>(kMaxEdgesKept / edges, 1, kMaxPlaces);
}

}  // namespace

EdgeHistory::EdgeHistory(const Experiment& experiment, std::int64_t last_tick, Source source)
    : source_(std::move(source)),
      row_(experiment.size()),
      keep_every_(last_tick / PlacesFor(experiment) + 1),
      meters_(std::make_unique<Meters>(experiment)) {
  kept_.emplace(0, std::make_unique<Meters>(*meters_));
}

/// Goes back to a place that is kept, or ahead to one, if that is nearer to `tick`.
void EdgeHistory::GoNear(std::int64_t tick) {
  const auto place = std::prev(kept_.upper_bound(tick + 1));
  if (next_ <= tick + 1 && next_ >= place->first) return;
  meters_ = std::make_unique<Meters>(*place->second);
  next_ = place->first;
}

bool EdgeHistory::Follow(std::int64_t tick, int rows, std::vector<EdgeNow>& edges) {
  GoNear(tick);
  while (next_ <= tick) {
    if (rows <= 0) return false;
    if (const auto now = source_.adopted_at(next_)) {
      meters_->links.Adopt(now);
      meters_->left_out.Adopt(now);
    }
    if (meters_->links.plain() && !meters_->left_out.is_needed()) {
      meters_->links.Add(next_, row_);
      next_ = std::min(tick + 1, source_.next_change(next_));
      continue;
    }
    --rows;
    source_.read(next_, row_);
    meters_->links.Add(next_, row_);
    meters_->left_out.Add(next_++, row_.motions);
    if (next_ % keep_every_ == 0) kept_.try_emplace(next_, std::make_unique<Meters>(*meters_));
  }
  meters_->links.EdgesNow(edges);
  meters_->left_out.Mark(edges);
  return true;
}

}  // namespace mascot
