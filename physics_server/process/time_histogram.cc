#include "physics_server/process/time_histogram.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

constexpr double kSmallest_s = 1e-9;
constexpr int kBinsOfAnOctave = 64, kOctaves = 50;  // up to 13 days

/// Bin 0 has what is shorter than kSmallest_s; the last one also has what is longer than all octaves.
std::size_t BinOf(double duration_s) {
  if (!(duration_s >= kSmallest_s)) return 0;
  const double place = 1 + std::floor(std::log2(duration_s / kSmallest_s) * kBinsOfAnOctave);
  return static_cast<std::size_t>(std::min<double>(place, kBinsOfAnOctave * kOctaves));
}

/// The middle of a bin, by ratio.
double MiddleOf(std::size_t bin) {
  return bin == 0 ? 0 : kSmallest_s * std::exp2((static_cast<double>(bin) - 0.5) / kBinsOfAnOctave);
}

}  // namespace

TimeHistogram::TimeHistogram() : bins_(1 + kBinsOfAnOctave * kOctaves, 0) {}

void TimeHistogram::Add(double duration_s) {
  ++bins_[BinOf(duration_s)];
  ++count_;
  largest_s_ = std::max(largest_s_, duration_s);
}

double TimeHistogram::Quantile(double part) const {
  if (part >= 1) return largest_s_;
  double passed = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    passed += static_cast<double>(bins_[bin]);
    if (passed > 0 && passed >= part * static_cast<double>(count_)) return std::min(MiddleOf(bin), largest_s_);
  }
  return largest_s_;
}

}  // namespace mascot
