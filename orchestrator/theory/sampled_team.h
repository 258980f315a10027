#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "base/linear_algebra.h"
#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// Discrete-time model of a linear team along one axis, with its timeline and its delays. If links lose samples, it is
/// the model of the mean over many seeds. It computes eigenvalues of dense matrices, and is thus for small teams only
/// (IsSmall).
///
/// The state is q_i of all agents, then v_i of all agents, then both as of 1, 2, ... ticks ago, up to the longest
/// delay.
class SampledTeam {
 public:
  /// `team` has at most one leader, which all others follow. `period_s` is the control period. The first three
  /// arguments must outlive this object.
  SampledTeam(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline, double period_s);
  /// Whether the state is small enough: at most 200 numbers.
  static bool IsSmall(const Experiment& experiment);

  /// Whether agents come to rest together: all eigenvalues of the map over one cycle, except that of agreement, lie
  /// inside the unit circle.
  bool Decays() const { return radius_ < 1; }
  /// The largest magnitude of the eigenvalues of disagreement, over one cycle.
  double slowest() const { return slowest_; }
  /// Decay rate of the disagreement (1/s).
  double rate_per_s() const;
  /// Where a team without a leader meets, as q in W (m). Decays() must be true.
  Eigen::Vector3d MeetingPoint() const;

 private:
  using Matrix = Eigen::MatrixXd;
  Eigen::Index Place(int id, std::int64_t ticks_ago) const;  // index of q in the state; that of v is n_ more
  Matrix Map(std::int64_t tick) const;
  void MoveAgent(int id, const Timeline::Interval& now, std::int64_t tick, Matrix& map) const;
  std::vector<std::int64_t> Changes(std::int64_t from, std::int64_t to) const;
  Matrix Over(std::int64_t from, std::int64_t to) const;
  Graph Heard() const;
  void FindModes();
  void JudgeRoots(const std::vector<int>& ids, const Eigensystem& modes);

  const Experiment& experiment_;
  const LinearTeam& team_;
  const Timeline& timeline_;
  double h_;
  Eigen::Index n_;
  int leader_ = 0;
  std::int64_t own_ticks_;
  std::int64_t reach_ = 0;   // the longest delay (ticks)
  std::int64_t steady_ = 0;  // first tick from which on the maps repeat with the timeline
  Matrix cycle_;             // map from steady_ over one cycle
  double radius_ = 0;        // largest magnitude of all eigenvalues but the 1 of agreement and the leader's
  double slowest_ = 0;
};

}  // namespace mascot
