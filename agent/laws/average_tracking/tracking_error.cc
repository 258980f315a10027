#include "agent/laws/average_tracking/tracking_error.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>

#include "agent/laws/parts/sampled_modes.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

std::int64_t SecondHalf(const Experiment& experiment) { return experiment.ticks() / 2; }

/// The magnitude of inputs and estimates (m).
double LargestInput_m(const Experiment& experiment, const std::vector<Input>& inputs) {
  double largest_m = 0;
  for (const Input& input : inputs)
    for (const double t_s : {0.0, experiment.run.duration_s})
      largest_m = std::max(largest_m, (input.constant_m + t_s * input.ramp_m_per_s).norm() + input.amplitude_m.norm());
  return largest_m;
}

using Phasors = Eigen::MatrixX3cd;  // a row for each agent

/// The swings of the inputs by their frequency, as phasors.
std::map<double, Phasors> Swings(const std::vector<Input>& inputs) {
  std::map<double, Phasors> swings;
  const auto count = static_cast<Eigen::Index>(inputs.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Input& input = inputs[static_cast<std::size_t>(i)];
    const auto swing = swings.try_emplace(input.frequency_hz, Phasors::Zero(count, 3)).first;
    swing->second.row(i) = input.amplitude_m.transpose() * std::polar(1.0, input.phase_rad);
  }
  swings.erase(0);  // it does not move
  return swings;
}

// Along a mode of L with lambda > 0, the error obeys d(k+1) = (1 - step lambda) d(k) + r(k+1) - r(k). A swing z^k keeps
// up (z - 1) / (z - (1 - step lambda)) of itself, with z = exp(2 pi j f h); a ramp keeps up h / (step lambda).
double ErrorBound_m(const Experiment& experiment, const std::vector<Input>& inputs, double step, std::int64_t from) {
  const SymmetricEigensystem modes = SymmetricEigensystemOf(experiment.graph.Laplacian());
  const Eigen::MatrixXd& v = modes.vectors;
  const Eigen::VectorXd& lambda = modes.values;
  const auto count = static_cast<Eigen::Index>(inputs.size());
  const double h = experiment.period_s();
  // V diag(gains) V' `signal`, without the mode of the mean.
  const auto kept_up = [&](const auto& gain, const Phasors& signal) {
    Phasors c = v.transpose() * signal;
    c.row(0).setZero();
    for (Eigen::Index n = 1; n < count; ++n) c.row(n) *= gain(lambda(n));
    return Phasors(v * c);
  };
  Phasors ramps(count, 3), starts(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    ramps.row(i) = inputs[static_cast<std::size_t>(i)].ramp_m_per_s.transpose();
    starts.row(i) = inputs[static_cast<std::size_t>(i)].At(0).transpose();
  }
  const Phasors lag = kept_up([&](double l) { return std::complex<double>(h / (step * l)); }, ramps);
  Eigen::MatrixX3d bound = lag.cwiseAbs();
  Eigen::MatrixX3d left = kept_up([](double) { return std::complex<double>(1); }, starts).real() - lag.real();
  for (const auto& [frequency_hz, swing] : Swings(inputs)) {
    const std::complex<double> z = std::polar(1.0, 2 * std::numbers::pi * frequency_hz * h);
    const Phasors steady = kept_up([&](double l) { return (z - 1.0) / (z - (1 - step * l)); }, swing);
    bound += steady.cwiseAbs();
    left -= steady.imag();  // at t = 0: a sine
  }
  const Eigen::Index axes = CountOf(experiment.law.axes);
  const double transient = std::pow(SlowestFactor(experiment, step), from) * left.leftCols(axes).norm();
  return bound.leftCols(axes).rowwise().norm().maxCoeff() + transient;
}

}  // namespace

std::vector<PredictedFigure> PredictTrackingError(const Experiment& experiment, const std::vector<Input>& inputs,
                                                  double step) {
  const double largest_m = LargestInput_m(experiment, inputs);
  const double terms = static_cast<double>(experiment.graph.edges()) + experiment.size();  // in the sum, at each tick
  return {{.values = {ErrorBound_m(experiment, inputs, step, SecondHalf(experiment))},
           .bound = Bound::kAtMost,
           .magnitude = largest_m},
          {.values = {0.0}, .bound = Bound::kAtMost, .magnitude = largest_m * terms}};
}

void TrackingErrorMeter::Add(const TeamRow& row) {
  now_m_.reset();
  Eigen::Vector3d sum_W = Eigen::Vector3d::Zero(), sum_r_W = sum_W;
  std::vector<Eigen::Vector3d> estimates_W;
  for (const int id : ids_) {
    const auto& message = row.messages[static_cast<std::size_t>(id - 1)];
    if (message.size() != 3) return;  // its law is off
    estimates_W.emplace_back(message[0], message[1], message[2]);
    sum_W += estimates_W.back();
    sum_r_W += inputs_[static_cast<std::size_t>(id - 1)].At(experiment_.time_s(row.tick));
  }
  sum_off_m_ = std::max(sum_off_m_, (sum_W - sum_r_W).norm());
  now_m_ = 0;
  for (const Eigen::Vector3d& x_W : estimates_W)
    now_m_ = std::max(*now_m_, Along(axes_, x_W - sum_r_W / static_cast<double>(ids_.size())).norm());
  if (row.tick >= SecondHalf(experiment_)) error_m_ = std::max(error_m_, *now_m_);
}

}  // namespace mascot
