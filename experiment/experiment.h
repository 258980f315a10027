#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/enum_names.h"
#include "experiment/airframe.h"
#include "experiment/events.h"
#include "experiment/false_data.h"
#include "experiment/faults.h"
#include "experiment/graph/graph.h"
#include "experiment/graph/schedule.h"
#include "experiment/hosts.h"
#include "experiment/link.h"
#include "experiment/model_traits.h"
#include "experiment/physics.h"
#include "experiment/safety.h"
#include "experiment/sensors.h"
#include "experiment/vehicles.h"

namespace mascot {

inline constexpr int kMaxAgents = 10000;

enum class Mode { kLockstep, kRealtime };
inline constexpr EnumNames<Mode, 2> kModes({{Mode::kLockstep, "lockstep"}, {Mode::kRealtime, "realtime"}});
/// What happens when an agent is lost, by an event or for real.
enum class OnAgentLoss {
  kAbort,   ///< the run ends, and has failed
  kHold,    ///< the agent's actuators keep their last values
  kDrop,    ///< they go to zero
  kRestart  ///< as kHold; after run.restart_after_s a fresh process of the agent takes its place
};
inline constexpr EnumNames<OnAgentLoss, 4> kOnAgentLoss({{OnAgentLoss::kAbort, "abort"},
                                                         {OnAgentLoss::kHold, "hold"},
                                                         {OnAgentLoss::kDrop, "drop"},
                                                         {OnAgentLoss::kRestart, "restart"}});
enum class Scheduler { kOther, kFifo };
inline constexpr EnumNames<Scheduler, 2> kSchedulers({{Scheduler::kOther, "other"}, {Scheduler::kFifo, "fifo"}});
enum class Axes { kXy, kXyz };
inline constexpr EnumNames<Axes, 2> kAxes({{Axes::kXy, "xy"}, {Axes::kXyz, "xyz"}});
/// Number of a vector's first components that the law controls: x and y, or all three.
constexpr int CountOf(Axes axes) { return axes == Axes::kXyz ? 3 : 2; }
/// `v` projected onto the axes that the law controls.
inline Eigen::Vector3d Along(Axes axes, Eigen::Vector3d v) {
  if (axes == Axes::kXy) v.z() = 0;
  return v;
}
enum class Inversion { kSmallAngle, kExact };
inline constexpr EnumNames<Inversion, 2> kInversions({{Inversion::kSmallAngle, "small_angle"},
                                                      {Inversion::kExact, "exact"}});
enum class DeliveryMode { kAuto, kBundled, kTopics };
inline constexpr EnumNames<DeliveryMode, 3> kDeliveries({{DeliveryMode::kAuto, "auto"},
                                                         {DeliveryMode::kBundled, "bundled"},
                                                         {DeliveryMode::kTopics, "topics"}});

enum class Security {
  kOff,
  kGraph  ///< certificates let nobody hear or say what the graph does not allow
};
inline constexpr EnumNames<Security, 2> kSecurities({{Security::kOff, "off"}, {Security::kGraph, "graph"}});
/// What Security::kGraph does to the samples, besides that it allows them.
enum class Protection { kNone, kSign, kEncrypt };
inline constexpr EnumNames<Protection, 3> kProtections({{Protection::kNone, "none"},
                                                        {Protection::kSign, "sign"},
                                                        {Protection::kEncrypt, "encrypt"}});

/// [control], or an agent's own control table.
struct ControlConfig {
  double heading_rad = 0;
  double max_acceleration_m_per_s2 = 3;
  double max_speed_m_per_s = 100;  ///< limit on a wanted velocity, per axis; accelerations may add up to more
  /// k_v (1/s): for a wanted velocity v*, a model driven by acceleration is commanded k_v (v* - v).
  double velocity_gain = 2;
  double look_ahead_m = 0.1;  ///< unicycle: distance to the point ahead that moves with the wanted velocity
  Inversion inversion = Inversion::kSmallAngle;
  bool drag_compensation = true;  ///< adds the known drag B v / m to the wanted acceleration
};

/// Parameters that a law has read from its own keys in [law]; each law derives its own type (agent/laws/). Read once,
/// then shared by all agents with that law.
struct LawParams {
  virtual ~LawParams() = default;
  bool sends_messages = false;
  std::size_t action = 0;  ///< how many numbers an action has that somebody outside gives the law; 0: it takes none
  std::string fixed;       ///< why no event can change law.params, as far as is known; empty: one can
  /// Why no event can change the law.params of `before`, those of the same law up to now, to these; empty: one can.
  virtual std::string WhyFixed(const LawParams& /*before*/) const { return fixed; }
  bool once_per_process = false;   ///< a process can have the law for one agent only
  std::vector<std::string> files;  ///< absolute paths of files that the law depends on; their contents are not in here
};

/// [law], or an agent's own law table.
struct LawConfig {
  std::string name;
  int leader = 0;  ///< 0 = none
  Axes axes = Axes::kXy;
  std::optional<SafetyConfig> safety = {};  ///< absent: only the limits change what the law wants
  std::shared_ptr<const LawParams> params;  ///< null if the experiment was read without laws (the physics server)
  std::int64_t since = 0;                   ///< tick at which the law began anew ([[law.schedule]])
};

/// What an experiment says about one agent.
struct AgentConfig {
  int id = 0;                                     ///< 1..N
  std::string model;                              ///< one of ModelNames()
  Airframe airframe;                              ///< with the gains and limits of `control` already applied
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< initial position (m)
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();  ///< initial velocity (m/s)
  double heading_rad = 0;                         ///< initial yaw
  ControlConfig control;
  LawConfig law;
  /// The agent's own targets (m), for laws that fly to waypoints and whose table has none; empty: it has none.
  std::vector<Eigen::Vector3d> waypoints_W = {};
  bool has_own_law = false;     ///< `law` is the agent's own, not the team's
  bool sends_messages = false;  ///< the agent's law sends messages in some phase: the agent has a topic for them
  bool takes_actions = false;   ///< the agent's law takes actions in some phase: the agent has a topic for them
  /// From start_s to stop_s the agent's law is on, and other agents may hear it; before start_s and from stop_s on, the
  /// agent is commanded the velocity 0.
  double start_s = 0;
  double stop_s = std::numeric_limits<double>::infinity();
  bool external = false;                    ///< the agent is started by hand, and the run waits for it
  std::string host = {};                    ///< name of one of Experiment::hosts; empty: the host of the physics server
  std::optional<FalseDataConfig> lie = {};  ///< absent: the agent tells the truth
  std::optional<VehicleConfig> vehicle = {};  ///< absent: its body is simulated
  AgentFaults faults = {};                    ///< what events have done to the agent

  const ModelTraits& traits() const { return TraitsOf(model); }
  /// Full lengths of the agent's collision shape along the axes of B (m).
  Eigen::Vector3d size_m() const {
    return traits().has_airframe ? airframe.size_m : Eigen::Vector3d::Constant(2 * kBallRadius_m);
  }
  /// Radius of the smallest ball around the agent's position that holds its body, however the body is turned (m).
  double radius_m() const { return traits().has_airframe ? airframe.size_m.norm() / 2 : kBallRadius_m; }
};

/// Whether code that a user has written for a law may run: it does when the law is tried, made or loaded.
enum class UserCode {
  kMayRun,
  kNeverRuns  ///< the experiment is looked at, and not flown: somebody else may have written it
};

/// One experiment: everything that the processes of a run must agree on. Field names are the TOML keys.
struct Experiment {
  /// TOML text with every default: the file that reproduces the run.
  std::string resolved;
  /// True if the experiment was read before without a mistake: slow checks (which run the code of a law) are left out.
  bool checked = false;
  UserCode user_code = UserCode::kMayRun;
  struct {
    std::string name;
    double duration_s = 0;
    Mode mode = Mode::kLockstep;
    std::uint64_t seed = 1;
    double agent_timeout_s = 5;
    double start_timeout_s = 60;
    OnAgentLoss on_agent_loss = OnAgentLoss::kAbort;
    double restart_after_s = 1;  ///< simulated time
    double speed = 1;
    std::optional<double> pace = {};  ///< simulated seconds per second in lockstep; 0: as fast as the machine can
    Scheduler scheduler = Scheduler::kOther;
    bool pin_cores = false;
    bool lock_memory = false;
  } run;
  PhysicsConfig physics;
  std::vector<AgentConfig> agents;
  struct {
    int rate_hz = 100;
    int python_memory_mb = 2000;  ///< limit on the memory of a process that runs a law in Python or Octave
  } control;
  /// All edges of all phases of `schedule`: which agent may ever hear which. DDS readers exist for these edges.
  Graph graph{{}};
  /// The graph over time: which agent hears which, and when.
  Schedule schedule;
  std::set<std::pair<int, int>> cut;  ///< edges (hearer, heard) that an event has cut: no sample is sent on them
  LinkTable links;
  SensorConfig sensors;
  LawConfig law;  ///< the team's; each agent has its own copy
  struct {
    std::string file;
    std::vector<std::string> topics;
    bool ros_types = false;  ///< the recording also has channels in standard types of ROS 2
    int rate_hz = 0;         ///< rows per simulated second; 0: every tick has one
  } record;
  struct {
    bool position_plot = true;
    bool velocity_plot = true;
    bool save_plot = true;
    bool show_plot = false;
    bool save_data = true;
    bool fidelity = true;  ///< the run is compared with ideal bodies; their laws run in the orchestrator too

    /// Whether pictures are to be drawn, as files or in windows.
    bool wants_pictures() const { return (save_plot || show_plot) && (position_plot || velocity_plot); }
  } output;
  struct {
    int domain = -1;  ///< -1 = "auto"
    std::string transport;
    int agents_per_process = 1;
    DeliveryMode delivery = DeliveryMode::kAuto;
    bool ros_view = false;
    bool crazyswarm = false;  ///< scripts for Crazyswarm2 fly the agents whose laws take actions
    Security security = Security::kOff;
    Protection protection = Protection::kNone;

    bool is_secure() const { return security == Security::kGraph; }
    /// Whether all that goes to a process at a tick goes in one sample, which is the faster way.
    bool is_bundled() const { return delivery != DeliveryMode::kTopics; }
  } network;
  std::vector<HostConfig> hosts;      ///< besides the host of the physics server
  std::size_t phase = 0;              ///< number of phases of [[law.schedule]] that have begun after the first
  std::vector<double> late_phases_s;  ///< times of phases of [[law.schedule]] that the run does not reach
  std::vector<Event> events;          ///< of the file, with the phases of [[law.schedule]], in order of time

  int size() const { return static_cast<int>(agents.size()); }
  const AgentConfig& agent(int id) const { return agents[static_cast<std::size_t>(id - 1)]; }
  /// The number K of the last tick: ticks run from 0 to K.
  std::int64_t ticks() const;
  double period_s() const { return 1.0 / control.rate_hz; }
  /// Simulated time of tick k: divided, never accumulated.
  double time_s(std::int64_t tick) const { return static_cast<double>(tick) / control.rate_hz; }
  /// From one row of the recording to the next.
  int ticks_per_row() const { return record.rate_hz == 0 ? 1 : control.rate_hz / record.rate_hz; }
  int steps_per_tick() const { return physics.rate_hz / control.rate_hz; }
};

/// Whether agents take actions (LawParams::action), at the start or later.
bool TakesActions(const Experiment& experiment);
/// Throws ConfigError if agents take actions, for commands that give none.
void RefuseActions(const Experiment& experiment);
/// Why run.on_agent_loss ends the run; empty: it does not.
std::string LossThatEndsTheRun(const Experiment& now);
/// What becomes of an agent that is lost, in words, where the run goes on.
std::string WhatFollowsALoss(const Experiment& experiment);

}  // namespace mascot
