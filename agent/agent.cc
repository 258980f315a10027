#include "agent/agent.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "agent/laws.h"

namespace mascot {
namespace {

/// As C++ prints it, but without the sign of a NaN, which is not worth a user's thought.
std::string Component(double value) {
  if (std::isnan(value)) return "nan";
  std::ostringstream text;
  text << value;
  return text.str();
}

[[noreturn]] void ThrowNotFinite(std::int64_t tick, int id, const Eigen::Vector3d& a_W) {
  throw std::runtime_error("tick " + std::to_string(tick) + ": agent " + std::to_string(id) +
                           ": the law's acceleration is not finite (" + Component(a_W.x()) + ", " + Component(a_W.y()) +
                           ", " + Component(a_W.z()) + ")");
}

}  // namespace

Agent::Agent(Experiment& experiment, int id)
    : id_(id),
      rate_hz_(experiment.control.rate_hz),
      limit_(experiment.control.max_acceleration_m_per_s2),
      hold_altitude_(experiment.law.axes == Axes::kXy),
      law_(MakeLaw(experiment, id)),
      controller_(MakeController(experiment, id)) {}

Command Agent::Want(std::int64_t tick, const Motion& self, std::span<const Heard> heard) {
  Command command;
  command.a_law_W = law_->Accel_W(static_cast<double>(tick) / rate_hz_, self, heard);
  if (hold_altitude_) command.a_law_W.z() = 0;
  if (!command.a_law_W.allFinite()) ThrowNotFinite(tick, id_, command.a_law_W);
  command.a_limited_W = command.a_law_W.cwiseMin(limit_).cwiseMax(-limit_);
  if (command.a_limited_W != command.a_law_W) command.flags |= kAccelerationLimited;
  return command;
}

Command Agent::Decide(std::int64_t tick, const Motion& self, std::span<const Heard> heard) {
  Command command = Want(tick, self, heard);
  const Controller::Output output = controller_->Actuate(self, command.a_limited_W);
  command.actuator = output.actuator;
  command.flags |= output.flags;
  return command;
}

}  // namespace mascot
