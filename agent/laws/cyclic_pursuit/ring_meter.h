#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "agent/laws/cyclic_pursuit/cyclic_modes.h"
#include "agent/laws/law_figures.h"

namespace mascot {

inline constexpr LawFigure kRingFigures[] = {
    {.name = "radius_m", .meaning = "rms distance from the centre in x and y, at the end"},
    {.name = "radius_ratio", .meaning = "that as a multiple of what it was at the start"},
    {.name = "turn_rate_rad_per_s", .meaning = "at which agents go round the centre to the left, at the end"},
};

/// Measures the figures of a ring of agents.
class RingMeter final : public LawMeter {
 public:
  RingMeter(const Experiment& experiment, std::span<const int> ids)
      : period_s_(experiment.period_s()), ids_(ids.begin(), ids.end()) {}
  void Add(const TeamRow& row) override {
    before_ = std::exchange(now_, {});
    for (const int id : ids_) now_.emplace_back(row.motions[static_cast<std::size_t>(id - 1)].p_WB.head<2>());
    motion_ = RingMotionOf(before_.empty() ? now_ : before_, now_, period_s_);
    if (row.tick == 0) start_m_ = motion_.radius_m;
  }
  std::vector<FigureValues> Figures() const override {
    if (start_m_ < kRoundedRadius_m) return {{motion_.radius_m}, {{}}, {{}}};
    return {{motion_.radius_m}, {motion_.radius_m / start_m_}, {motion_.turn_rate_rad_per_s}};
  }
  std::optional<double> Curve() const override { return motion_.radius_m; }

 private:
  double period_s_;
  std::vector<int> ids_;
  std::vector<Eigen::Vector2d> before_, now_;
  RingMotion motion_;
  double start_m_ = 0;
};

}  // namespace mascot
