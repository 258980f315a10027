#include "orchestrator/theory/sampled_team.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "orchestrator/theory/links_on_average.h"

namespace mascot {
namespace {

constexpr Eigen::Index kLargestState = 200;  // numbers; the eigenvalues take 0.1 s

Eigen::MatrixXd Power(Eigen::MatrixXd base, std::int64_t exponent) {
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(base.rows(), base.cols());
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) power = power * base;
    base = base * base;
  }
  return power;
}

}  // namespace

bool SampledTeam::IsSmall(const Experiment& experiment) {
  return std::int64_t{2} * experiment.size() * (LongestDelayTicks(experiment) + 1) <= kLargestState;
}

SampledTeam::SampledTeam(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline,
                         double period_s)
    : experiment_(experiment),
      team_(team),
      timeline_(timeline),
      h_(period_s),
      n_(experiment.size()),
      own_ticks_(OwnDelayTicks(experiment)),
      reach_(LongestDelayTicks(experiment)) {
  if (!team.Leaders().empty()) leader_ = team.Leaders().front();
  // A sample arrives only if the edge existed when it was sent: maps repeat one longest delay after the graph does.
  steady_ = timeline.cycle_from + reach_;
  cycle_ = Over(steady_, steady_ + timeline.cycle_ticks);
  FindModes();
}

Eigen::Index SampledTeam::Place(int id, std::int64_t ticks_ago) const {
  return 2 * n_ * static_cast<Eigen::Index>(ticks_ago) + id - 1;
}

// Fills the rows of one agent's next q and v: u = sum_j a_ij [p (q_j - q_i) + g (v_j - v_i)] - b v_i, with delayed
// neighbours' and own states.
void SampledTeam::MoveAgent(int id, const Timeline::Interval& now, std::int64_t tick, Matrix& map) const {
  const LinearAgent& agent = team_.agent(id);
  const Eigen::Index q = Place(id, 0), v = q + n_, q_known = Place(id, own_ticks_), v_known = q_known + n_;
  Eigen::RowVectorXd u = Eigen::RowVectorXd::Zero(map.cols());
  const bool on = now.on[static_cast<std::size_t>(id - 1)];
  if (on && agent.listens) {
    for (const Graph::Neighbour& edge : experiment_.graph.HeardBy(id)) {
      const std::int64_t ago = DelayTicks(experiment_, id, edge.id);
      const double weight = timeline_.WeightOf(id, edge.id, tick - ago);
      if (weight == 0) continue;
      const Eigen::Index q_heard = Place(edge.id, ago), v_heard = q_heard + n_;
      u(q_heard) += weight * agent.p;
      u(q_known) -= weight * agent.p;
      u(v_heard) += weight * agent.g;
      u(v_known) -= weight * agent.g;
    }
  }
  u(v_known) -= on ? agent.b - agent.drag_b : agent.off_b - agent.drag_b;
  u(v) -= agent.drag_b;
  if (agent.order == 2 && (on || agent.hold < 1)) {
    map.row(v) = h_ * u;
    map(v, v) += 1;
    map.row(q) = agent.hold * h_ * h_ * u;
    map(q, v) += h_;
  } else {  // the law sets the velocity, which is 0 while the law is off
    map.row(v) = u;
    map.row(q) = h_ * u;
  }
  map(q, q) += 1;
}

SampledTeam::Matrix SampledTeam::Map(std::int64_t tick) const {
  const Eigen::Index size = 2 * n_ * static_cast<Eigen::Index>(reach_ + 1);
  Matrix map = Matrix::Zero(size, size);
  const Timeline::Interval& now = timeline_.At(tick);
  for (const AgentConfig& agent : experiment_.agents) MoveAgent(agent.id, now, tick, map);
  if (reach_ > 0) map.bottomLeftCorner(size - 2 * n_, size - 2 * n_).setIdentity();
  return map;
}

/// `from`, the ticks in between at which the map may change, and `to`.
std::vector<std::int64_t> SampledTeam::Changes(std::int64_t from, std::int64_t to) const {
  std::set<std::int64_t> delays = {0};
  for (int id = 1; id <= experiment_.size(); ++id)
    for (const Graph::Neighbour& heard : experiment_.graph.HeardBy(id)) {
      const std::int64_t ticks = DelayTicks(experiment_, id, heard.id);
      if (ticks <= reach_) delays.insert(ticks);
    }
  std::set<std::int64_t> changes = {from, to};
  const auto add = [&](std::int64_t tick) {
    if (tick > from && tick < to) changes.insert(tick);
  };
  for (const std::int64_t delay : delays)
    for (const Timeline::Interval& interval : timeline_.intervals)
      for (std::int64_t tick = interval.from + delay; tick < to; tick += timeline_.cycle_ticks) {
        add(tick);
        if (interval.from < timeline_.cycle_from || timeline_.cycle_ticks == 1) break;
      }
  return {changes.begin(), changes.end()};
}

SampledTeam::Matrix SampledTeam::Over(std::int64_t from, std::int64_t to) const {
  const std::vector<std::int64_t> changes = Changes(from, to);
  Matrix over = Power(Map(changes[0]), changes[1] - changes[0]);
  for (std::size_t i = 1; i + 1 < changes.size(); ++i)
    over = Power(Map(changes[i]), changes[i + 1] - changes[i]) * over;
  return over;
}

/// The union of the graphs of one cycle, without the edges on which the leader hears.
Graph SampledTeam::Heard() const {
  std::vector<Schedule::Phase> phases;
  for (const Timeline::Interval& interval : timeline_.intervals)
    if (interval.from >= timeline_.cycle_from) phases.push_back({0, team_.Followed(interval.graph)});
  return Schedule(std::move(phases), 0, 0).Union();
}

// Eigenvalues are computed for each strongly connected component by itself: the map is block triangular in the order of
// the components. This keeps the accuracy of eigenvalues that repeat along chains (they are defective). Those of the
// leader do not count.
void SampledTeam::FindModes() {
  const Graph heard = Heard();
  const int root = leader_ > 0 ? leader_ : heard.Roots().front();
  for (const std::vector<int>& ids : heard.Components()) {
    std::vector<Eigen::Index> places;
    for (std::int64_t ago = 0; ago <= reach_; ++ago)
      for (const int id : ids) places.insert(places.end(), {Place(id, ago), Place(id, ago) + n_});
    const Eigensystem modes = EigensystemOf(cycle_(places, places));
    if (!std::ranges::binary_search(ids, root))
      slowest_ = std::max(slowest_, modes.values.cwiseAbs().maxCoeff());
    else if (leader_ == 0)
      JudgeRoots(ids, modes);
  }
  radius_ = std::max(radius_, slowest_);
}

// One eigenvalue, 1, belongs to agreement. Others may do so too: those of agents at one place that slow down together,
// and those of a single root, which does not move if it starts from rest. A single root without damping goes on as it
// started, and does not count: its eigenvalue 1 is double.
void SampledTeam::JudgeRoots(const std::vector<int>& ids, const Eigensystem& modes) {
  const LinearAgent& first = team_.agent(ids.front());
  if (ids.size() == 1 && first.order == 2 && first.b == 0) return;
  const bool at_rest = experiment_.agent(ids.front()).v_W.isZero(0) || (team_.Common() && reach_ == 0);
  Eigen::Index one = 0;
  (modes.values.array() - 1.0).abs().minCoeff(&one);
  for (Eigen::Index k = 0; k < modes.values.size(); ++k) {
    if (k == one) continue;
    const double magnitude = std::abs(modes.values(k));
    radius_ = std::max(radius_, magnitude);
    const Eigen::VectorXcd shape = modes.vectors.col(k);
    double apart = 0;  // shape holds q, v of each agent now, then of earlier ticks
    for (std::size_t i = 1; i < ids.size(); ++i)
      apart = std::max(apart, std::abs(shape(2 * static_cast<Eigen::Index>(i)) - shape(0)));
    if (apart > 1e-6 * shape.norm() || (ids.size() == 1 && !at_rest)) slowest_ = std::max(slowest_, magnitude);
  }
}

double SampledTeam::rate_per_s() const {
  return -std::log(slowest_) / (static_cast<double>(timeline_.cycle_ticks) * h_);
}

// Each cycle conserves w' state, where w is the left eigenvector of the eigenvalue 1 of the cycle's map; its right
// eigenvector is agreement (q = 1, v = 0). With w' agreement = 1, the team thus meets at w' state(steady_).
Eigen::Vector3d SampledTeam::MeetingPoint() const {
  const Eigen::Index size = cycle_.rows();
  Eigen::VectorXd agreement = Eigen::VectorXd::Zero(size);
  Matrix state(size, 3);
  for (Eigen::Index i = 0; i < size; ++i) {
    const bool is_q = i % (2 * n_) < n_;
    const AgentConfig& agent = experiment_.agent(static_cast<int>(i % n_) + 1);
    agreement(i) = is_q;
    state.row(i) = is_q ? agent.p_W - team_.place_W[static_cast<std::size_t>(i % n_)] : agent.v_W;
  }
  Matrix keeps(size + 1, size);
  keeps << cycle_.transpose() - Matrix::Identity(size, size), agreement.transpose();
  const Eigen::VectorXd kept = LeastSquares(keeps, Eigen::VectorXd::Unit(size + 1, size));
  if (steady_ > 0) state = Over(0, steady_) * state;
  return (kept.transpose() * state).transpose();
}

}  // namespace mascot
