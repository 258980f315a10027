#include "agent/laws/swing_meter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mascot {
namespace {

constexpr double kNoSwing = 1e-18;  // (m/s)^2

}  // namespace

SwingMeter::SwingMeter(const Experiment& experiment, std::span<const int> ids, double w, double v_x)
    : experiment_(&experiment), w_(w), v_x_(v_x), swings_(experiment.agents.size()) {
  for (const int id : ids)
    if (id > 1) followers_.push_back(id);
}

std::optional<std::int64_t> SwingMeter::FirstTick(const Experiment& experiment, double w) {
  const double period = 2 * std::numbers::pi / w * experiment.control.rate_hz;  // in ticks
  const auto last = static_cast<double>(experiment.ticks());
  if (std::round(period) > last) return std::nullopt;
  return static_cast<std::int64_t>(std::round(last - std::max(1.0, std::floor(last / 2 / period)) * period)) + 1;
}

void SwingMeter::Add(const TeamRow& row) {
  const auto x = [&](int id) { return row.motions[static_cast<std::size_t>(id - 1)].p_WB.x(); };
  for (const int id : followers_) {
    const double gap_m = std::abs(x(id - 1) - x(id));
    least_gap_m_ = std::min(gap_m, least_gap_m_.value_or(gap_m));
  }
  const std::optional<std::int64_t> first = FirstTick(*experiment_, w_);
  if (!first || row.tick < *first) return;
  const double angle = w_ * experiment_->time_s(row.tick);
  const std::complex<double> turn(std::cos(angle), -std::sin(angle));
  for (std::size_t i = 0; i < swings_.size(); ++i) swings_[i] += turn * (row.motions[i].v_WB.x() - v_x_);
}

std::vector<FigureValues> SwingMeter::Figures() const {
  FigureValues growth;
  std::optional<double> largest;
  for (const int id : followers_) {
    const double own = std::norm(swings_[static_cast<std::size_t>(id - 1)]);
    const double before = std::norm(swings_[static_cast<std::size_t>(id - 2)]);
    growth.push_back(before > kNoSwing ? std::optional(std::sqrt(own / before)) : std::nullopt);
    if (growth.back()) largest = std::max(*growth.back(), largest.value_or(0));
  }
  return {growth, {largest}, {least_gap_m_}};
}

}  // namespace mascot
