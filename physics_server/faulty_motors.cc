#include "physics_server/faulty_motors.h"

#include <algorithm>

#include "base/ticks.h"

namespace mascot {

FaultyMotors::FaultyMotors(const Experiment& experiment)
    : rate_hz_(experiment.control.rate_hz),
      seed_(experiment.run.seed),
      drops_(experiment.run.on_agent_loss == OnAgentLoss::kDrop),
      last_(experiment.agents.size()) {}

void FaultyMotors::Adopt(const Experiment& now) {
  stopped_.clear();
  std::map<std::pair<int, int>, Motor> before = std::move(faulty_);
  faulty_.clear();
  for (const AgentConfig& agent : now.agents) {
    const auto i = static_cast<std::size_t>(agent.id - 1);
    if (drops_ && agent.faults.is_lost()) stopped_.push_back(i);
    for (const PartFault& fault : agent.faults.parts) {
      if (fault.fault.of != FaultPart::kMotor) continue;
      const std::pair key(agent.id, fault.fault.motor);
      const auto known = before.find(key);
      if (known != before.end() && known->second.fault.since == fault.since) {
        faulty_.insert(*known);
        continue;
      }
      const auto number = static_cast<std::size_t>(fault.fault.motor - 1);
      faulty_.insert({key,
                      {.fault = fault,
                       .dice = Dice(seed_, Dice::Stream::kFaultyMotor, static_cast<std::uint64_t>(agent.id), number),
                       .held = last_[i][number]}});
    }
  }
}

std::span<const Actuation> FaultyMotors::CarriedOut(std::int64_t tick, std::span<const Actuation> commands) {
  std::ranges::copy(commands, last_.begin());
  for (auto& [key, motor] : faulty_) {
    double& value = last_[static_cast<std::size_t>(key.first - 1)][static_cast<std::size_t>(key.second - 1)];
    value = CarriedOut(tick, value, motor);
  }
  for (const std::size_t i : stopped_) last_[i].fill(0);
  return last_;
}

double FaultyMotors::CarriedOut(std::int64_t tick, double command, Motor& motor) const {
  const Fault& fault = motor.fault.fault;
  switch (fault.kind) {
    case FaultKind::kOff:
      return 0;
    case FaultKind::kStuck:
      return motor.held;
    case FaultKind::kGarbage:
      return 2 * command * motor.dice.Unit(tick, 0);
    case FaultKind::kWrong:
      return fault.remaining * command;
    case FaultKind::kSlow:
      if ((tick - motor.fault.since) % PeriodInTicks(fault.period_s, rate_hz_) == 0) motor.held = command;
      return motor.held;
    case FaultKind::kDelayed:
      motor.late.push_back(command);
      if (std::ssize(motor.late) > TicksRoundedUp(fault.delay_s, rate_hz_)) {
        motor.held = motor.late.front();
        motor.late.pop_front();
      }
      return motor.held;
    case FaultKind::kIntermittent:
      return motor.dice.Unit(tick, 0) < fault.probability ? 0 : command;
    default:
      return command;
  }
}

}  // namespace mascot
