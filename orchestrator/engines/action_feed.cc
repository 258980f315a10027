#include "orchestrator/engines/action_feed.h"

#include "agent/laws/laws.h"

namespace mascot {

void ActionFeed::Take(const Event& event) {
  if (!live_) live_.emplace(experiment_, &LawTable(), /*checked=*/true);
  live_->Take(event);
}

void ActionFeed::GoTo(std::int64_t tick) {
  if (live_) held_.Adopt(live_->current());
  if (source_ == nullptr) return;
  ForEachAction(*source_, tick, [this](int id, std::span<const double> action) { held_.Act(id, action); });
}

}  // namespace mascot
