#pragma once

#include <memory>
#include <span>

#include "agent/controller.h"
#include "agent/faulty_sensor.h"
#include "agent/laws/law.h"
#include "agent/neighbours.h"
#include "agent/safety.h"
#include "agent/sensor.h"
#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// One agent without its communication and its low-level stack (LowLevel): it decides what the agent hears and
/// measures, and runs its law and its limits. Both engines run this class. The experiment must outlive it.
class Agent {
 public:
  Agent(const Experiment& experiment, int id);

  int id() const { return id_; }
  /// Whether the agent answers nothing: its Decide() must not be called.
  bool is_lost() const { return config_->faults.is_lost(); }
  /// Whether the law runs code that a user has written.
  bool AsksCodeOfUser() const;
  /// Returns when the law can be asked at once (Law::AwaitStart).
  void AwaitLaw() { law_->AwaitStart(); }
  /// Call it when events have changed the experiment: from the next Sense() on, the experiment is `now`. If a fresh
  /// agent has taken this one's place, all that this one remembers is forgotten.
  void Adopt(std::shared_ptr<const Experiment> now);
  /// Measures the agent's own motion and hears its neighbours: call it once at a tick, before Decide(). `self` is the
  /// true motion at `tick`, `samples` are what the agents in graph.HeardBy(id) sent at this tick, in that order. Ticks
  /// increase from call to call.
  void Sense(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// What the law gets at the tick of the last Sense(): the measured motion, and what was heard (valid until the next
  /// Sense()).
  const Motion& measured() const { return measured_; }
  std::span<const Heard> heard() const { return heard_; }
  /// What somebody outside wants of the agent (Law::Act), from the next Decide() on.
  void Act(std::span<const double> action) { law_->Act(action); }
  /// Evaluates the law and its limits at the tick of the last Sense(): fills in the command's accelerations, velocities
  /// and their flags. Throws std::runtime_error naming agent and tick if the law fails or its answer is not finite.
  Command Decide();
  /// Sense(), then Decide(). A debugger may stop here (docs/replay.md): it is not inline.
  Command Want(std::int64_t tick, const Motion& self, std::span<const Sample> samples);
  /// What the low-level stack gets for `command`, which the last Decide() returned. Valid until the next call.
  Controller::Input Driven(const Command& command) const {
    return {&measured_, driven_by_ == Wanted::kVelocity ? command.v_limited_W : command.a_limited_W};
  }
  /// The message that the law sends after the last Decide(); empty: none. Valid until the next call.
  std::span<const double> message() const { return message_; }
  /// Counters of the edges from graph.HeardBy(id), in that order.
  std::vector<EdgeCount> counts() const { return neighbours_.counts(); }

 private:
  void AdoptSensorFault(const Experiment& now);
  /// What the law wants, checked to be finite; velocity 0 while the law is off (start_s, stop_s).
  Eigen::Vector3d AskLaw();
  void LimitAcceleration(const Eigen::Vector3d& a_W, Command& command);
  void LimitVelocity(const Eigen::Vector3d& v_W, Command& command);
  void AccelerateTowards(const Eigen::Vector3d& v_W, Command& command);
  void Integrate(const Eigen::Vector3d& a_W, Command& command);
  /// The command for `wanted_W`, which the limit has made `limited_W`: this, or what the safety filter makes of
  /// `wanted_W`, whose flags are set.
  Eigen::Vector3d Safe(const Eigen::Vector3d& wanted_W, const Eigen::Vector3d& limited_W, double limit,
                       Command& command);

  std::shared_ptr<const Experiment> now_;  // null before the first event
  const AgentConfig* config_;
  int id_;
  double rate_hz_;
  bool holds_altitude_;
  std::shared_ptr<const Experiment> law_made_for_;  // what law_ may refer to; null: the experiment of the start
  std::unique_ptr<Law> law_;
  Wanted driven_by_;
  Wanted wanted_ = Wanted::kAcceleration;  // what the last AskLaw() returned
  Neighbours neighbours_;
  SafetyFilter safety_;
  OwnSensor sensor_;
  std::optional<FaultySensor> faulty_sensor_;
  RangeSensor ranges_;
  std::int64_t tick_ = -1;  // of the last Sense()
  Motion measured_;
  bool has_measured_ = false;
  bool is_restarted_ = false;  // and has not answered yet
  std::span<const Heard> heard_;
  Eigen::Vector3d v_integrated_W_;  // for a velocity-driven model whose law wants accelerations
  std::span<const double> message_;
};

}  // namespace mascot
