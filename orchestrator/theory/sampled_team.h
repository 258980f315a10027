#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <optional>
#include <string>

#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// A linear team along one axis, as it moves from tick to tick, with everything that a timeline and delays do to it. On
/// average where links lose samples. Eigenvalues of dense matrices: for small teams, as IsSmall says.
///
/// The state is q_i, then v_i of all agents, then both as they were 1, 2, ... ticks ago, as far as delays reach.
class SampledTeam {
 public:
  /// A team without leaders, or with one, whom the others follow; all three outlive this. `period_s`: of control.
  SampledTeam(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline, double period_s);
  static bool IsSmall(const Experiment& experiment);

  /// Agents come to rest together: all eigenvalues of one cycle's map lie within the unit circle, but the one of
  /// agreement.
  bool Decays() const { return radius_ < 1; }
  /// The largest magnitude of the eigenvalues that make agents disagree: over one cycle.
  double slowest() const { return slowest_; }
  double rate_per_s() const;
  /// Where a team without leader that decays meets: q, all axes.
  Eigen::Vector3d MeetingPoint() const;

 private:
  using Matrix = Eigen::MatrixXd;
  Eigen::Index Place(int id, std::int64_t ticks_ago) const;  // of q; v follows n further on
  Matrix Map(std::int64_t tick) const;
  void MoveAgent(int id, const Timeline::Interval& now, std::int64_t tick, Matrix& map) const;
  std::vector<std::int64_t> Changes(std::int64_t from, std::int64_t to) const;
  Matrix Over(std::int64_t from, std::int64_t to) const;
  Graph Heard() const;
  void FindModes();
  void JudgeRoots(const std::vector<int>& ids, const Eigen::EigenSolver<Matrix>& modes);

  const Experiment& experiment_;
  const LinearTeam& team_;
  const Timeline& timeline_;
  double h_;
  Eigen::Index n_;
  int leader_ = 0;
  std::int64_t own_ticks_;
  std::int64_t reach_ = 0;   // the longest delay (ticks)
  std::int64_t steady_ = 0;  // from this tick on the maps repeat with the timeline
  Matrix cycle_;             // from steady_ over one cycle
  double radius_ = 0;        // largest magnitude of all eigenvalues but that of agreement
  double slowest_ = 0;
};

}  // namespace mascot
