#include "orchestrator/measuring/decay_meter.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

constexpr double kUpperEnd = 0.1;
constexpr std::array<double, 2> kLowerEnds = {2e-4, 1e-3};  // the first one that the value stays below is used

}  // namespace

void DecayMeter::Add(double t_s, double value) {
  if (!first_) first_ = value;
  if (*first_ == 0) return;
  const double fraction = value / *first_;
  if (fraction > kUpperEnd) {  // the decline begins anew, with this row
    now_ = {};
    declines_ = {};
    from_s_ = t_s;
  }
  constexpr double kFloor = 1e-9;  // least fraction used: a zero crossing must not give log(0)
  const double t = t_s - from_s_, y = std::log(std::max(fraction, kFloor));
  ++now_.rows;
  now_.t += t;
  now_.y += y;
  now_.tt += t * t;
  now_.ty += t * y;
  for (std::size_t i = 0; i < kLowerEnds.size(); ++i)
    if (fraction > kLowerEnds[i]) declines_[i] = now_;
}

std::optional<double> DecayMeter::rate_per_s() const {
  constexpr std::int64_t kLeast = 3;
  for (const Sums& decline : declines_) {
    if (decline.rows < kLeast || 10 * (now_.rows - decline.rows) < decline.rows) continue;
    const auto n = static_cast<double>(decline.rows);
    return (decline.t * decline.y - n * decline.ty) / (n * decline.tt - decline.t * decline.t);
  }
  return std::nullopt;
}

}  // namespace mascot
