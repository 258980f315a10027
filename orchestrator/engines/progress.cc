#include "orchestrator/engines/progress.h"

#include <fmt/format.h>

namespace mascot {

void Progress::Add(const FlownRow& row) {
  const auto now = WallClock::now();
  if (start_ == WallClock::time_point{}) start_ = now;
  if (now < next_ && row.tick() < experiment_.ticks()) return;
  next_ = now + std::chrono::milliseconds(100);
  const double t_s = experiment_.time_s(row.tick());
  const double wall_s = std::chrono::duration<double>(now - start_).count();
  console_.Progress(static_cast<double>(row.tick()) / static_cast<double>(experiment_.ticks()),
                    fmt::format("t = {:.2f} of {:g} s | {:.1f} x real time | {} agent{} | disagreement {:.3g} m", t_s,
                                experiment_.run.duration_s, wall_s > 0 ? t_s / wall_s : 0.0, experiment_.size(),
                                experiment_.size() == 1 ? "" : "s", meter_.disagreement_m()));
}

}  // namespace mascot
