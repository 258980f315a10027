#include "experiment/experiment.h"

#include <cmath>

namespace mascot {

std::int64_t Experiment::ticks() const { return std::llround(run.duration_s * control.rate_hz); }

}  // namespace mascot
