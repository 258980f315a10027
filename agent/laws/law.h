#pragma once

#include <Eigen/Core>
#include <span>

#include "base/motion.h"

namespace mascot {

struct AgentConfig;

/// Largest number of values in a message.
inline constexpr std::size_t kMaxMessage = 64;

/// What one agent heard from one neighbour: the newest sample that has arrived.
struct Heard {
  int id = 0;
  double weight = 0;                     ///< a_ij when the sample was sent
  Motion motion = {};                    ///< the neighbour's motion, with measurement noise
  double age_s = 0;                      ///< simulated time since the sample was sent
  std::span<const double> message = {};  ///< the last message of the neighbour's law before the sample; empty: none
};

/// The control law of one agent: decides what the agent wants from its own motion and from what it has heard. No clock,
/// no I/O, no DDS: an answer depends only on the arguments of this call and of earlier ones.
class Law {
 public:
  virtual ~Law() = default;
  /// What Want_W() returns.
  virtual Wanted wanted() const { return Wanted::kAcceleration; }
  /// What the agent sees of obstacles: for each obstacle within sensors.range_m of the agent's measured position, the
  /// point nearest to it, in W (m), in the order of physics.obstacles; inside an obstacle, the position itself. Called
  /// before each Want_W() if sensors.range_m is set; `nearest_W` is valid until Want_W() has returned.
  virtual void See(std::span<const Eigen::Vector3d> /*nearest_W*/) {}
  /// What somebody outside wants of the agent from the next Want_W() on: LawParams::action numbers. Called for laws
  /// that take actions, before Want_W() of a tick, whenever there is a new one.
  virtual void Act(std::span<const double> /*action*/) {}
  /// Wanted acceleration (m/s^2) or velocity (m/s) of this agent, expressed in W. `t_s`: simulated time since the law
  /// began (LawConfig::since), increasing from call to call. `self`: the measured motion of this agent. `heard`: one
  /// entry for each neighbour whose sample has arrived, in increasing id. Components outside law.axes are ignored. An
  /// exception ends the run.
  virtual Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) = 0;
  /// The message for the agents that hear this one, called after Want_W() of the same tick: at most kMaxMessage
  /// numbers, valid until the next call; empty: no message. Called only for laws that send messages
  /// (LawParams::sends_messages).
  virtual std::span<const double> Message() { return {}; }
  /// Called when an event has changed the experiment: from the next Want_W() on, `agent` is what the experiment says
  /// about this agent. The law keeps what it remembers. `agent` lives until the next Adopt() has returned. This is for
  /// the laws of the table; laws in shared libraries have Set() (agent/laws/plugin/plugin.h).
  virtual void Adopt(const AgentConfig& /*agent*/) {}
  /// Returns when the law can be asked at once. Called, for laws of the table, before a run over DDS begins, when the
  /// laws of all agents of the process have been made; a law that has started another program waits for it here, or in
  /// the first Want_W(). An exception ends the run.
  virtual void AwaitStart() {}
};

}  // namespace mascot
