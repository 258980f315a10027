#include "agent/laws/containment/flown_lag.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace mascot {
namespace {

/// The edges on which followers hear, by their index among the followers; -1 is a leader.
struct FollowersEdge {
  Eigen::Index hearer = 0, heard = 0;
  double weight = 0;
};

std::vector<FollowersEdge> EdgesOfFollowers(const Graph& graph, const LedTeam& team) {
  const auto index = [&](int id) {
    return team.IsLeader(id) ? -1 : std::ranges::lower_bound(team.followers, id) - team.followers.begin();
  };
  std::vector<FollowersEdge> edges;
  for (const int id : team.followers)
    for (const Graph::Neighbour& j : graph.HeardBy(id)) edges.push_back({index(id), index(j.id), j.weight});
  return edges;
}

}  // namespace

// d = p - p_end obeys d_i+ = d_i + h gain sum_j a_ij (d_j - d_i), and is 0 of leaders.
std::optional<FlownLag> FlyToPlaces(const Experiment& experiment, const LedTeam& team, double gain,
                                    const Eigen::MatrixXd& shares, const Eigen::MatrixX3d& lag) {
  constexpr double kSettledShare = 0.02, kThere = 1e-12;
  const Axes axes = experiment.law.axes;
  const std::vector<FollowersEdge> edges = EdgesOfFollowers(experiment.graph, team);
  const double most = kMaxFlownFollowers / static_cast<double>(edges.size() + team.followers.size());
  if (static_cast<double>(experiment.ticks()) > most) return std::nullopt;
  const double step = experiment.period_s() * gain;
  Eigen::MatrixX3d d = StartsOf(experiment, team.followers) - shares * StartsOf(experiment, team.leaders) + lag;
  const double start_m = LongestRow(d, axes);
  FlownLag flown{.lag_m = LongestRow(lag, axes)};
  std::int64_t tick = 0, last_off = -1;  // last_off: the newest tick with more than the share
  for (; static_cast<double>(tick) <= most; ++tick) {
    const double now_m = LongestRow(d, axes);
    if (tick == experiment.ticks()) flown.lag_m = LongestRow(d - lag, axes);
    if (now_m > kSettledShare * start_m) last_off = tick;
    if (now_m <= kThere * start_m) break;
    Eigen::MatrixX3d next = d;
    for (const FollowersEdge& edge : edges) {
      next.row(edge.hearer) -= step * edge.weight * d.row(edge.hearer);
      if (edge.heard >= 0) next.row(edge.hearer) += step * edge.weight * d.row(edge.heard);
    }
    d = std::move(next);
  }
  const bool ran_out = static_cast<double>(tick) > most;
  if (last_off + 1 < tick || !ran_out) flown.settled = HoldsFrom{experiment.time_s(last_off + 1)};
  return flown;
}

}  // namespace mascot
