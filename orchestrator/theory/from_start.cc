#include "orchestrator/theory/from_start.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/laws/parts/rounding.h"
#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/theory/links_on_average.h"

namespace mascot {
namespace {

constexpr double kRoundedShare = 1e-14;  // of positions: what a mean of equal ones is off by

using Vectors = std::vector<Eigen::Vector3d>;  // one an agent, by id - 1

/// Positions less places, and velocities, of all agents at one tick.
struct TeamState {
  Vectors q, v;
};

class Flight {
 public:
  Flight(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline)
      : experiment_(experiment), team_(team), timeline_(timeline), own_ticks_(OwnDelayTicks(experiment)) {
    for (const AgentConfig& agent : experiment.agents)
      for (const Graph::Neighbour& heard : experiment.graph.HeardBy(agent.id)) {
        if (!team.agent(agent.id).listens || Delivered(experiment.links.Of(agent.id, heard.id)) == 0) continue;
        edges_.push_back({agent.id, heard.id, DelayTicks(experiment, agent.id, heard.id), 0});
      }
    TeamState start;
    for (const AgentConfig& agent : experiment.agents) {
      start.q.push_back(agent.p_W - team.place_W[Index(agent.id)]);
      start.v.push_back(agent.v_W);
    }
    past_.assign(static_cast<std::size_t>(LongestDelayTicks(experiment)) + 1, start);
    u_.resize(start.q.size());
  }

  /// Agents and edges to look at in each tick.
  double size() const { return static_cast<double>(edges_.size() + u_.size()); }
  std::int64_t reach() const { return std::ssize(past_) - 1; }
  const Vectors& q() const { return At(0).q; }
  /// The largest component of a velocity (m/s).
  double fastest() const {
    double fastest = 0;
    for (const Eigen::Vector3d& v : At(0).v) fastest = std::max(fastest, v.cwiseAbs().maxCoeff());
    return fastest;
  }
  std::int64_t tick() const { return tick_; }
  /// Whether a limit has cut what a law asks for, along its axes.
  bool is_cut() const { return is_cut_; }
  void Step();

 private:
  struct Edge {
    int hearer, heard;
    std::int64_t ago;
    double weight;  // of the sample that arrives now; 0: none does
  };

  static std::size_t Index(int id) { return static_cast<std::size_t>(id - 1); }
  const TeamState& At(std::int64_t ago) const {
    return past_[static_cast<std::size_t>((tick_ + std::ssize(past_) - ago) % std::ssize(past_))];
  }
  void Weigh(const Timeline::Interval& now);
  void Couple();
  /// What the limits leave of what agent `i` wants: an acceleration, or a velocity, while it knows itself at `v`.
  Eigen::Vector3d Limited(std::size_t i, const Eigen::Vector3d& u, const Eigen::Vector3d& v);
  Eigen::Vector3d Clamped(std::size_t i, const Eigen::Vector3d& u, double limit);

  const Experiment& experiment_;
  const LinearTeam& team_;
  const Timeline& timeline_;
  std::int64_t own_ticks_;
  std::vector<Edge> edges_;
  std::vector<TeamState> past_;  // that of tick k at k modulo its size
  Vectors u_;                    // what the laws want; scratch
  TeamState next_;               // scratch
  std::int64_t tick_ = 0;
  bool is_cut_ = false;
};

void Flight::Weigh(const Timeline::Interval& now) {
  if (timeline_.IsConstant() && tick_ > reach()) return;
  for (Edge& edge : edges_)
    edge.weight = now.on[Index(edge.hearer)] ? timeline_.WeightOf(edge.hearer, edge.heard, tick_ - edge.ago) : 0;
}

void Flight::Couple() {
  const TeamState& known = At(own_ticks_);
  for (Eigen::Vector3d& u : u_) u.setZero();
  for (const Edge& edge : edges_) {
    if (edge.weight == 0) continue;
    const LinearAgent& agent = team_.agent(edge.hearer);
    const std::size_t i = Index(edge.hearer), j = Index(edge.heard);
    const TeamState& heard = At(edge.ago);
    u_[i] += edge.weight * (agent.p * (heard.q[j] - known.q[i]) + agent.g * (heard.v[j] - known.v[i]));
  }
}

Eigen::Vector3d Flight::Clamped(std::size_t i, const Eigen::Vector3d& u, double limit) {
  const Eigen::Vector3d clamped = u.cwiseMin(limit).cwiseMax(-limit);
  const auto along = CountOf(experiment_.agents[i].law.axes);
  is_cut_ = is_cut_ || clamped.head(along) != u.head(along);
  return clamped;
}

// As Agent::Want() does. What is not cut keeps its bits.
Eigen::Vector3d Flight::Limited(std::size_t i, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const AgentConfig& agent = experiment_.agents[i];
  const double max_m_per_s2 = agent.control.max_acceleration_m_per_s2, max_m_per_s = agent.control.max_speed_m_per_s;
  const bool by_velocity = agent.traits().driven_by == Wanted::kVelocity;
  if (team_.agents[i].order == 1) return Clamped(i, u, max_m_per_s);
  if (by_velocity) {  // it integrates what the law wants
    const double h = experiment_.period_s();
    const Eigen::Vector3d a = Clamped(i, u, max_m_per_s2), next_v = v + h * a;
    return next_v.cwiseAbs().maxCoeff() <= max_m_per_s ? a : (Clamped(i, next_v, max_m_per_s) - v) / h;
  }
  if (WantedBy(agent.law) == Wanted::kVelocity) {
    const double k_v = agent.control.velocity_gain;
    const Eigen::Vector3d wanted_v = u / k_v + v;
    if (wanted_v.cwiseAbs().maxCoeff() > max_m_per_s)
      return Clamped(i, k_v * (Clamped(i, wanted_v, max_m_per_s) - v), max_m_per_s2);
  }
  return Clamped(i, u, max_m_per_s2);
}

void Flight::Step() {
  const Timeline::Interval& now = timeline_.At(tick_);
  Weigh(now);
  Couple();
  const TeamState& known = At(own_ticks_);
  TeamState& next = next_ = At(0);
  const double h = experiment_.period_s();
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const LinearAgent& agent = team_.agents[i];
    const bool on = now.on[i];
    u_[i] -= ((on ? agent.b : agent.off_b) - agent.drag_b) * known.v[i];
    u_[i] = Limited(i, u_[i], known.v[i]) - agent.drag_b * next.v[i];
    if (agent.order == 2 && (on || agent.hold < 1)) {
      next.q[i] += h * next.v[i] + agent.hold * h * h * u_[i];
      next.v[i] += h * u_[i];
    } else {  // the law sets the velocity, which is 0 while the law is off
      next.q[i] += h * u_[i];
      next.v[i] = u_[i];
    }
  }
  ++tick_;
  std::swap(past_[static_cast<std::size_t>(tick_ % std::ssize(past_))], next_);
}

}  // namespace

FromStart FlyFromStart(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline,
                       double longest_s) {
  Flight flight(experiment, team, timeline);
  const double longest = longest_s * experiment.control.rate_hz;
  if (longest * flight.size() > kMaxSteps) return {};
  AgreementMeter meter(experiment);
  ResponseRecorder response;
  meter.Add(flight.q());
  const double first_m = meter.disagreement_m();
  if (first_m <= kRoundedShare * LargestStart_m(experiment)) {
    while (static_cast<double>(flight.tick()) < longest) flight.Step();  // together
    return {.is_flown = true, .agrees = true, .is_cut = flight.is_cut()};
  }
  response.Add(first_m);
  constexpr double kAgreed = 1e-7;   // of the first disagreement
  std::int64_t tick = 0, apart = 0;  // apart: the newest tick with more disagreement
  FromStart by_the_end;              // of the run, whose rows are those that are measured
  while (static_cast<double>(tick) < longest && tick - apart <= apart / 5 + flight.reach() + 1) {
    flight.Step();
    ++tick;
    meter.Add(flight.q());
    if (tick <= experiment.ticks()) response.Add(meter.disagreement_m());
    if (meter.disagreement_m() > kAgreed * first_m) apart = tick;
    if (tick == experiment.ticks())
      by_the_end = {.settling_time_s = meter.settling_time_s(), .rate_per_s = meter.rate_per_s()};
  }
  constexpr double kMet = 1e-3;  // of the first disagreement
  const double drift_m = flight.fastest() * experiment.time_s(tick);
  const bool met = meter.disagreement_m() <= kMet * first_m && drift_m <= kMet * first_m;
  return {.is_flown = true,
          .settling_time_s = by_the_end.settling_time_s ? by_the_end.settling_time_s : meter.settling_time_s(),
          .rate_per_s = by_the_end.rate_per_s ? by_the_end.rate_per_s : meter.rate_per_s(),
          .is_cut = flight.is_cut(),
          .value_m = met ? std::optional(meter.mean_W()) : std::nullopt,
          .response = response.Take()};
}

}  // namespace mascot
