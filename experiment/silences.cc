#include "experiment/silences.h"

#include <algorithm>

namespace mascot {

void Silences::Take(const Event& event) {
  if (event.fault && event.fault->IsLoss()) {
    std::vector<Span>& spans = spans_[event.fault->agent];
    if (!spans.empty() && spans.back().to < 0) return;  // it is lost already
    spans.push_back({.from = std::max<std::int64_t>(0, event.fault->unanswered ? event.tick - 1 : event.tick)});
  }
  if (!event.restart) return;
  const auto found = spans_.find(*event.restart);
  if (found != spans_.end() && found->second.back().to < 0) found->second.back().to = event.tick;
}

bool Silences::Has(int agent, std::int64_t tick) const {
  const auto found = spans_.find(agent);
  return found != spans_.end() && std::ranges::any_of(found->second, [&](const Span& span) {
           return tick >= span.from && (span.to < 0 || tick < span.to);
         });
}

}  // namespace mascot
