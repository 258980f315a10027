#include "physics_server/process/progress_watch.h"

namespace mascot {

bool ProgressWatch::IsOverdue(std::int64_t progress, Time now, Seconds grace) {
  if (progress != seen_) {
    seen_ = progress;
    since_ = now;
  }
  return now - since_ > limit_ + grace;
}

}  // namespace mascot
