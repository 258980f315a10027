#include "orchestrator/engines/progress.h"

#include <cstdio>

namespace mascot {

void Progress::Show(std::int64_t tick) {
  const auto now = WallClock::now();
  if (start_ == WallClock::time_point{}) start_ = now;
  if (now < next_ && tick < experiment_.ticks()) return;
  next_ = now + std::chrono::milliseconds(100);
  const double t_s = experiment_.time_s(tick);
  const double wall_s = std::chrono::duration<double>(now - start_).count();
  char text[160];
  std::snprintf(text, sizeof text, "t = %.2f of %g s | %.1f x real time | %d agent%s | disagreement %.3g m", t_s,
                experiment_.run.duration_s, wall_s > 0 ? t_s / wall_s : 0.0, experiment_.size(),
                experiment_.size() == 1 ? "" : "s", writer_.meter().disagreement_m());
  console_.Progress(static_cast<double>(tick) / static_cast<double>(experiment_.ticks()), text);
}

}  // namespace mascot
