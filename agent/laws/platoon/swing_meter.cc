#include "agent/laws/platoon/swing_meter.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mascot {
namespace {

constexpr double kNoSwing_m_per_s = 1e-9;
constexpr double kMaxChange = 0.01;  // of a swing of the long run, as a share of it

/// Which half of what is looked at a tick belongs to: 0, 1, or -1 for neither.
int HalfOf(std::int64_t tick, const Experiment& experiment, double w) {
  const double period = 2 * std::numbers::pi / w * experiment.control.rate_hz;  // in ticks
  const auto last = static_cast<double>(experiment.ticks());
  if (std::round(2 * period) > last) return -1;
  const double half = std::max(1.0, std::floor(last / 4 / period)) * period;
  const auto begins = [&](double halves) { return static_cast<std::int64_t>(std::round(last - halves * half)) + 1; };
  if (tick < begins(2)) return -1;
  return tick < begins(1) ? 0 : 1;
}

}  // namespace

std::complex<double> SwingFit::Swing() const {
  const Eigen::Vector3d x = normal_.completeOrthogonalDecomposition().solve(right_);
  return {x.y(), x.z()};
}

SwingMeter::SwingMeter(const Experiment& experiment, std::span<const int> ids, double w, double forward)
    : experiment_(&experiment), w_(w), forward_(forward), fits_(experiment.agents.size()) {
  for (const int id : ids)
    if (id > 1) followers_.push_back(id);
}

void SwingMeter::Add(const TeamRow& row) {
  const auto x = [&](int id) { return row.motions[static_cast<std::size_t>(id - 1)].p_WB.x(); };
  gap_m_.reset();
  for (const int id : followers_) {
    const double gap_m = forward_ * (x(id - 1) - x(id));
    gap_m_ = std::min(gap_m, gap_m_.value_or(gap_m));
  }
  if (gap_m_) least_gap_m_ = std::min(*gap_m_, least_gap_m_.value_or(*gap_m_));
  const int half = w_ > 0 ? HalfOf(row.tick, *experiment_, w_) : -1;
  if (half < 0) return;
  const double angle_rad = w_ * experiment_->time_s(row.tick);
  for (std::size_t i = 0; i < fits_.size(); ++i)
    fits_[i][static_cast<std::size_t>(half)].Add(angle_rad, row.motions[i].v_WB.x());
}

std::optional<std::complex<double>> SwingMeter::SwingOf(int id) const {
  const auto& [before, last] = fits_[static_cast<std::size_t>(id - 1)];
  const std::complex<double> swing = last.Swing();
  const bool settled = std::abs(swing - before.Swing()) <= kMaxChange * std::abs(swing);
  return settled && std::abs(swing) > kNoSwing_m_per_s ? std::optional(swing) : std::nullopt;
}

std::vector<FigureValues> SwingMeter::Figures() const {
  FigureValues growth;
  std::optional<double> largest = 0;
  for (const int id : followers_) {
    const auto before = SwingOf(id - 1), own = SwingOf(id);
    growth.push_back(before && own ? std::optional(std::abs(*own) / std::abs(*before)) : std::nullopt);
    largest = largest && growth.back() ? std::optional(std::max(*growth.back(), *largest)) : std::nullopt;
  }
  if (followers_.empty()) largest.reset();
  return {growth, {largest}, {least_gap_m_}, {std::nullopt}};
}

}  // namespace mascot
