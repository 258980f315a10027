#pragma once

#include <memory>
#include <span>

#include "agent/controller.h"
#include "agent/law.h"
#include "agent/neighbours.h"
#include "agent/sensor.h"
#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// One agent without a wire: what it hears and measures, its law, limits, low-level stack. Both engines run this.
class Agent {
 public:
  Agent(const Experiment& experiment, int id);

  int id() const { return id_; }
  /// `self` is where the agent is, `samples` what those that the graph lets it hear sent at this tick
  /// (Neighbours::Hear). The law and its limits only: a_law_W, a_limited_W, v_limited_W and their flags. Ticks
  /// increase. Throws std::runtime_error naming agent and tick if the law's answer is not finite.
  Command Want(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// Want, then the low-level stack: the complete command. Throws likewise.
  Command Decide(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// What the law sends after the last Want or Decide; empty: nothing. Valid until the next.
  std::span<const double> message() const { return message_; }
  std::vector<EdgeCount> counts() const { return neighbours_.counts(); }

 private:
  /// What the law wants, finite; an agent whose law is off wants to stand still.
  Eigen::Vector3d AskLaw(std::int64_t tick, const Motion& measured, std::span<const Heard> heard);
  void LimitAcceleration(const Eigen::Vector3d& a_W, Command& command) const;
  void LimitVelocity(const Eigen::Vector3d& v_W, Command& command) const;

  const AgentConfig& config_;
  int id_;
  double rate_hz_;
  bool holds_altitude_;
  std::unique_ptr<Law> law_;
  std::unique_ptr<Controller> controller_;
  Wanted driven_by_;
  Wanted wanted_ = Wanted::kAcceleration;  // what the last answer of AskLaw was
  Neighbours neighbours_;
  OwnSensor sensor_;
  Motion measured_;
  Eigen::Vector3d v_integrated_W_;  // of a velocity-driven model whose law wants accelerations
  std::span<const double> message_;
};

}  // namespace mascot
