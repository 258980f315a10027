#include "agent/agent.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

/// `value` as text; a NaN without its sign.
std::string Component(double value) { return std::isnan(value) ? "nan" : fmt::format("{:g}", value); }

[[noreturn]] void ThrowNotFinite(std::int64_t tick, int id, Wanted wanted, const Eigen::Vector3d& w) {
  throw std::runtime_error("tick " + std::to_string(tick) + ": agent " + std::to_string(id) + ": the law's " +
                           (wanted == Wanted::kVelocity ? "velocity" : "acceleration") + " is not finite (" +
                           Component(w.x()) + ", " + Component(w.y()) + ", " + Component(w.z()) + ")");
}

/// Returns what `call` returns; puts the tick in front of the message of an exception.
template <class Call>
auto AtTick(std::int64_t tick, Call call) {
  try {
    return call();
  } catch (const std::exception& failure) {
    throw std::runtime_error("tick " + std::to_string(tick) + ": " + failure.what());
  }
}

Eigen::Vector3d Clamped(const Eigen::Vector3d& v, double limit) { return v.cwiseMin(limit).cwiseMax(-limit); }

}  // namespace

Agent::Agent(const Experiment& experiment, int id)
    : config_(&experiment.agent(id)),
      id_(id),
      rate_hz_(experiment.control.rate_hz),
      holds_altitude_(config_->law.axes == Axes::kXy),
      law_(MakeLaw(experiment, id)),
      driven_by_(config_->traits().driven_by),
      neighbours_(experiment, id),
      safety_(experiment, id),
      sensor_(experiment.sensors, experiment.control.rate_hz, experiment.run.seed, id),
      ranges_(experiment.sensors.range_m, experiment.physics.obstacles),
      v_integrated_W_(config_->v_W) {}

void Agent::Adopt(std::shared_ptr<const Experiment> now) {
  const bool is_fresh = now->agent(id_).faults.restarted != config_->faults.restarted;
  const bool begins = is_fresh || now->agent(id_).law.since != config_->law.since;
  config_ = &now->agent(id_);
  neighbours_.Adopt(*now);
  safety_.Adopt(*now);
  if (begins) {
    law_.reset();  // before the next one: a process may be able to have the law only once
    law_ = MakeLaw(*now, id_);
    law_made_for_ = now;
  } else {
    law_->Adopt(*config_);
  }
  if (is_fresh) {
    sensor_ = OwnSensor(now->sensors, now->control.rate_hz, now->run.seed, id_);
    faulty_sensor_.reset();
    has_measured_ = false;
    is_restarted_ = true;
    message_ = {};
  }
  AdoptSensorFault(*now);
  now_ = std::move(now);  // the last one ends here: nothing refers to it any more
}

void Agent::AdoptSensorFault(const Experiment& now) {
  const PartFault* fault = config_->faults.Of(FaultPart::kSensor);
  if (fault == nullptr)
    faulty_sensor_.reset();
  else if (!faulty_sensor_ || faulty_sensor_->since() != fault->since)
    faulty_sensor_.emplace(*fault, now.control.rate_hz, now.run.seed,
                           has_measured_ ? std::optional(measured_) : std::nullopt);
}

bool Agent::AsksCodeOfUser() const { return EntryOf(config_->law).is_of_user; }

Eigen::Vector3d Agent::AskLaw() {
  const double t_s = static_cast<double>(tick_) / rate_hz_;
  message_ = {};
  if (!IsOn(*config_, t_s)) {
    wanted_ = Wanted::kVelocity;
    return Eigen::Vector3d::Zero();
  }
  wanted_ = law_->wanted();
  if (ranges_.is_on()) AtTick(tick_, [&] { law_->See(ranges_.Sense(measured_.p_WB)); });
  const double law_t_s = static_cast<double>(tick_ - config_->law.since) / rate_hz_;
  Eigen::Vector3d w_W = AtTick(tick_, [&] { return law_->Want_W(law_t_s, measured_, heard_); });
  if (holds_altitude_) w_W.z() = 0;
  if (!w_W.allFinite()) ThrowNotFinite(tick_, id_, wanted_, w_W);
  if (config_->law.params->sends_messages) message_ = AtTick(tick_, [&] { return law_->Message(); });
  return w_W;
}

Eigen::Vector3d Agent::Safe(const Eigen::Vector3d& wanted_W, const Eigen::Vector3d& limited_W, double limit,
                            Command& command) {
  if (!safety_.is_on()) return limited_W;
  const SafetyFilter::Answer safe = safety_.Nearest(wanted_W, limit, measured_, heard_);
  if (safe.u_W != limited_W) command.flags |= kSafetyFiltered;
  if (!safe.is_feasible) command.flags |= kSafetyInfeasible;
  return safe.u_W;
}

// Writes the law's acceleration and its limited value into `command`, with the flags. The limited value is safe, if the
// model is driven by it.
void Agent::LimitAcceleration(const Eigen::Vector3d& a_W, Command& command) {
  const double limit = config_->control.max_acceleration_m_per_s2;
  command.a_law_W = a_W;
  command.a_limited_W = Clamped(a_W, limit);
  if (command.a_limited_W != a_W) command.flags |= kAccelerationLimited;
  if (driven_by_ == Wanted::kAcceleration) command.a_limited_W = Safe(a_W, command.a_limited_W, limit, command);
}

// Writes a wanted velocity and its limited value into `command`, with the flags. The limited value is safe, if the
// model is driven by it.
void Agent::LimitVelocity(const Eigen::Vector3d& v_W, Command& command) {
  const double limit = config_->control.max_speed_m_per_s;
  command.v_law_W = v_W;
  command.v_limited_W = Clamped(v_W, limit);
  if (command.v_limited_W != v_W) command.flags |= kSpeedLimited;
  if (driven_by_ == Wanted::kVelocity) command.v_limited_W = Safe(v_W, command.v_limited_W, limit, command);
}

// For a model driven by acceleration: writes what the wanted velocity v* means for it, k_v (v* - v), before all limits
// and after the limits of the velocity and of the acceleration.
void Agent::AccelerateTowards(const Eigen::Vector3d& v_W, Command& command) {
  const auto accelerate = [&](const Eigen::Vector3d& to_W) {
    Eigen::Vector3d a_W = config_->control.velocity_gain * (to_W - measured_.v_WB);
    if (holds_altitude_) a_W.z() = 0;
    return a_W;
  };
  LimitVelocity(v_W, command);
  LimitAcceleration(accelerate(command.v_limited_W), command);
  command.a_law_W = accelerate(v_W);
}

// For a model driven by velocity: integrates the wanted acceleration over one tick. Where the limit of the velocity
// or the safety filter changes the result, another acceleration than wanted is commanded.
void Agent::Integrate(const Eigen::Vector3d& a_W, Command& command) {
  LimitAcceleration(a_W, command);
  LimitVelocity(v_integrated_W_ + command.a_limited_W / rate_hz_, command);
  const auto cut = command.v_limited_W.array() != command.v_law_W.array();
  command.a_limited_W = cut.select((command.v_limited_W - v_integrated_W_) * rate_hz_, command.a_limited_W).eval();
}

void Agent::Sense(std::int64_t tick, const Motion& self, std::span<const Sample> samples) {
  tick_ = tick;
  heard_ = neighbours_.Hear(tick, self, samples);
  measured_ = sensor_.Measure(tick, self);
  if (faulty_sensor_) measured_ = faulty_sensor_->Measure(tick, measured_);
  has_measured_ = true;
  if (std::exchange(is_restarted_, false)) v_integrated_W_ = measured_.v_WB;
}

Command Agent::Want(std::int64_t tick, const Motion& self, std::span<const Sample> samples) {
  Sense(tick, self, samples);
  return Decide();
}

Command Agent::Decide() {
  const Eigen::Vector3d w_W = AskLaw();
  Command command;
  if (driven_by_ == Wanted::kVelocity && wanted_ == Wanted::kVelocity)
    LimitVelocity(w_W, command);
  else if (driven_by_ == Wanted::kVelocity)
    Integrate(w_W, command);
  else if (wanted_ == Wanted::kVelocity)
    AccelerateTowards(w_W, command);
  else
    LimitAcceleration(w_W, command);
  v_integrated_W_ = command.v_limited_W;
  return command;
}

}  // namespace mascot
