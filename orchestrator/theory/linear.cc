// Linear laws: consensus, formation, velocity consensus, and teams that mix them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/laws/parts/reach.h"
#include "base/linear_algebra.h"
#include "base/ticks.h"
#include "orchestrator/theory/from_start.h"
#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/links_on_average.h"
#include "orchestrator/theory/meeting_point.h"
#include "orchestrator/theory/parts.h"
#include "orchestrator/theory/period_bound.h"
#include "orchestrator/theory/sampled_team.h"
#include "orchestrator/theory/turning.h"

namespace mascot {
namespace {

/// Predicts an experiment with a linear team.
class LinearCase {
 public:
  LinearCase(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline, Prediction& prediction)
      : experiment_(experiment),
        team_(team),
        timeline_(timeline),
        prediction_(prediction),
        graph_(team.Followed(timeline.intervals.back().graph)),
        common_(team.Common()) {}

  void Predict();

 private:
  const AgentConfig& agent(int id) const { return experiment_.agent(id); }
  /// Whether the team has modes: a constant graph, and agents that are alike.
  bool IsModal() const { return timeline_.IsConstant() && common_.has_value(); }
  bool IsDelayed() const { return LongestDelay(experiment_) > 0 || experiment_.sensors.own_delay_s > 0; }
  int FreeRoot() const;
  bool MayCoast() const;
  std::optional<double> LinkMargin() const {
    return prediction_.delay_margin ? prediction_.delay_margin->margin_s : std::nullopt;
  }
  void FindModes();
  GainBound Gain() const;
  bool JudgeGains();
  bool JudgeTurning();
  bool JudgeDelays();
  std::optional<double> OwnMargin() const;
  /// The delay that one of `delay_s` amounts to: a whole number of control periods (s).
  double InPeriods(double delay_s) const {
    return experiment_.time_s(TicksRoundedUp(delay_s, experiment_.control.rate_hz));
  }
  bool Exceeds(double delay_s, std::optional<double> margin_s) const {
    return margin_s && InPeriods(delay_s) > *margin_s - experiment_.period_s() / 2;
  }
  /// Text on a margin and a delay that exceeds it.
  std::string Bound(double margin_s, double delay_s) const {
    return fmt::format("below {:.4g}, got {:.4g}{}", margin_s, delay_s,
                       delay_s < margin_s ? ", which whole control periods make as long" : "");
  }
  void WarnOfDelays() const;
  bool PredictMotion();
  bool PredictSampled();
  void PredictValue();
  void PredictFromStart();
  bool TakeLimited(const FromStart& limited);
  void WarnOfLag(int leader) const;
  bool Silent(const std::string& why) const {
    prediction_.silent = why;
    return false;
  }
  bool Warn(const std::string& warning) const {
    prediction_.warnings.push_back(warning);
    prediction_.stable = false;
    return false;
  }

  const Experiment& experiment_;
  const LinearTeam& team_;
  const Timeline& timeline_;
  Prediction& prediction_;
  Graph graph_;  // graph of the last interval, without the edges on which leaders hear
  std::optional<LinearAgent> common_;
  Eigen::VectorXcd lambda_;        // if IsModal(): eigenvalues of L; the first is that of agreement or of the leader
  std::vector<LinearMode> modes_;  // if IsModal(): modes of the other eigenvalues
};

void LinearCase::Predict() {
  if (IsModal()) FindModes();
  if (!JudgeGains() || !JudgeDelays()) return;
  if (PredictMotion()) {
    PredictValue();
    PredictFromStart();
  } else if (!prediction_.stable) {
    WarnOfDelays();
  }
}

void LinearCase::FindModes() {
  lambda_ = graph_.Eigenvalues();
  for (Eigen::Index i = 1; i < lambda_.size(); ++i) modes_.push_back(common_->Mode(lambda_(i)));
}

/// The gain that must be larger if modes do not decay, and its least value.
GainBound LinearCase::Gain() const {
  const LinearAgent& all = *common_;
  const bool relative = all.g > 0, velocity = WantedBy(experiment_.law) == Wanted::kVelocity;
  double least = 0;
  for (Eigen::Index i = 1; i < lambda_.size(); ++i)
    least = std::max(least, relative ? MinRelativeDamping(all.p, all.b, lambda_(i)) : MinDamping(all.p, 0, lambda_(i)));
  if (relative) return {"law.v_gain", least, all.g};
  const double own = all.b - all.drag_b;
  if (velocity) {
    // Here own = k_v and p = k_v p_gain: (k_v + drag)^2 > k_v p_gain (Im lambda)^2 / Re lambda.
    const double half = least * least / own / 2 - all.drag_b;
    const double root = half * half - all.drag_b * all.drag_b;
    return {"control.velocity_gain", half > 0 && root >= 0 ? half + std::sqrt(root) : 0, own};
  }
  return {"law.beta", std::max(0.0, least - all.drag_b), own};
}

/// On a constant graph, the agent that hears no other, is no leader, and is followed by all others, if it has no
/// damping (b = 0): it goes on as it started. 0: there is none.
int LinearCase::FreeRoot() const {
  if (!team_.Leaders().empty() || !timeline_.IsConstant()) return 0;
  const std::vector<int> roots = graph_.Roots();
  const LinearAgent& root = team_.agent(roots.front());
  return roots.size() == 1 && root.order == 2 && root.b == 0 ? roots.front() : 0;
}

/// Whether agents might keep moving together after they have met: no agent leads or rests, and some have no damping.
bool LinearCase::MayCoast() const {
  if (const int root = FreeRoot(); root > 0 && RestingPlace(experiment_, team_, root)) return false;
  return team_.Leaders().empty() &&
         std::ranges::any_of(team_.agents, [](const LinearAgent& moves) { return moves.order == 2 && moves.b == 0; });
}

bool LinearCase::JudgeGains() {
  std::vector<int> idle;
  for (const AgentConfig& a : experiment_.agents)
    if (team_.agent(a.id).listens && team_.agent(a.id).p == 0) idle.push_back(a.id);
  if (!idle.empty())
    return Warn(
        fmt::format("law.p_gain: 0 means that nothing pulls {} anywhere", common_ ? "an agent" : AgentList(idle)));
  if (!timeline_.IsConstant()) return true;
  if (common_) {
    const bool stable = JudgeModes(experiment_, modes_, Gain(), prediction_) && JudgeTurning();
    if (!stable) prediction_.stable = false;
    return stable;
  }
  if (MayCoast() || !PeriodBoundIsKnown(experiment_)) return true;
  const double longest_s = PeriodBound(experiment_, team_, timeline_);
  if (longest_s == 0) return Warn("law: the gains of these agents are unstable together");
  if (JudgePeriod(experiment_, longest_s, prediction_)) return true;
  prediction_.stable = false;
  return false;
}

/// Whether the modes decay also on quadrotors, which turn before they accelerate.
bool LinearCase::JudgeTurning() {
  std::vector<int> ids;
  for (const Eigen::Index i : team_.Listening()) ids.push_back(static_cast<int>(i) + 1);
  const double p_gain = LinearFormOf(agent(ids.front()).law)->p;
  return mascot::JudgeTurning(experiment_, ids, *common_, modes_, "law.p_gain", p_gain, prediction_);
}

/// The margin of a delay that own states have too.
std::optional<double> LinearCase::OwnMargin() const {
  if (!common_ || common_->drag_b > 0 || modes_.empty()) return std::nullopt;
  double margin_s = std::numeric_limits<double>::infinity();
  for (const LinearMode& mode : modes_) {
    const std::optional<double> own_s = OwnDelayMargin(mode, experiment_.period_s());
    if (!own_s) return std::nullopt;
    margin_s = std::min(margin_s, *own_s);
  }
  return margin_s;
}

/// Finds the delay margins. Returns false, with a warning, if the delays exceed them.
bool LinearCase::JudgeDelays() {
  if (!timeline_.IsConstant()) return true;
  const double link_s = LongestDelay(experiment_), own_s = experiment_.sensors.own_delay_s;
  prediction_.delay_margin = LinkDelayMargin(team_, graph_, experiment_.period_s());
  prediction_.own_delay_margin_s = OwnMargin();
  // The margins hold for delays that are all equal. With unequal delays the team may tolerate more.
  if (!RandomAge(experiment_).empty() || !CommonDelayTicks(experiment_, graph_)) return true;
  if (own_s == 0 && prediction_.delay_margin) {
    if (Exceeds(link_s, LinkMargin()))
      return Warn(fmt::format("link.delay_s: unstable, it must be {}", Bound(*LinkMargin(), link_s)));
    if (IsModal()) prediction_.stable = true;  // JudgeGains has judged the team without delays
  }
  if (InPeriods(own_s) == InPeriods(link_s) && prediction_.own_delay_margin_s) {
    if (Exceeds(own_s, prediction_.own_delay_margin_s))
      return Warn(
          fmt::format("sensors.own.delay_s: unstable, it must be {}", Bound(*prediction_.own_delay_margin_s, own_s)));
    prediction_.stable = true;
  }
  return true;
}

/// Warns of unequal delays that exceed the margins for equal ones, where no eigenvalues decide about stability.
void LinearCase::WarnOfDelays() const {
  const double link_s = LongestDelay(experiment_), own_s = experiment_.sensors.own_delay_s;
  if (own_s == 0 && Exceeds(link_s, LinkMargin()))
    prediction_.warnings.push_back(
        fmt::format("link.delay_s: perhaps unstable, samples come up to {:.4g} s late; if all did, it would have to be "
                    "below {:.4g}",
                    InPeriods(link_s), *LinkMargin()));
  if (Exceeds(own_s, prediction_.own_delay_margin_s))
    prediction_.warnings.push_back(
        fmt::format("sensors.own.delay_s: perhaps unstable, got {:.4g}; if neighbours' samples were as late, it would "
                    "have to be below {:.4g}",
                    InPeriods(own_s), *prediction_.own_delay_margin_s));
}

/// Predicts stability, rate and settling time. Returns false if nothing else can be predicted.
bool LinearCase::PredictMotion() {
  if (const std::string random = RandomAge(experiment_); !random.empty()) return Silent(random);
  if (!IsModal() || IsDelayed()) return PredictSampled();
  prediction_.stable = true;
  if (modes_.empty()) return true;
  prediction_.slowest_rate_per_s = DecayRate(modes_, experiment_.period_s());
  prediction_.settling_time_s = SettlingTime(modes_, experiment_.period_s());
  return true;
}

bool LinearCase::PredictSampled() {
  if (!SampledTeam::IsSmall(experiment_))
    return prediction_.stable.has_value() ||  // JudgeDelays knows
           Silent("so many agents, different or with so long delays, are more than its eigenvalues are computed for");
  if (MayCoast() && !(IsModal() && IsDelayed() && FreeRoot() == 0))
    return Silent("law.beta is 0: agents who have met may go on together");
  const SampledTeam sampled(experiment_, team_, timeline_, experiment_.period_s());
  prediction_.stable = sampled.Decays();
  if (!*prediction_.stable) {
    const double own_s = experiment_.sensors.own_delay_s, link_s = LongestDelay(experiment_);
    if (own_s > 0) return Warn(fmt::format("sensors.own.delay_s: unstable with this delay, got {:.4g}", own_s));
    if (link_s > 0) return Warn(fmt::format("link.delay_s: unstable with this delay, got {:.4g}", link_s));
    return Warn("law: unstable with these gains on these graphs");
  }
  if (sampled.slowest() == 0) return true;  // no agent follows another
  prediction_.slowest_rate_per_s = sampled.rate_per_s();
  if (timeline_.cycle_from == 0)
    prediction_.settling_time_s = std::log(50) / sampled.rate_per_s();  // nothing begins later
  return true;
}

void LinearCase::PredictValue() {
  const std::vector<int> leaders = team_.Leaders();
  if (const int root = FreeRoot(); root > 0) {
    prediction_.value_m = RestingPlace(experiment_, team_, root);
  } else if (leaders.empty()) {
    prediction_.value_m = timeline_.IsConstant() ? MeetingPoint(experiment_, team_, graph_) : std::nullopt;
    if (!prediction_.value_m && SampledTeam::IsSmall(experiment_) && (!IsModal() || IsDelayed()))
      prediction_.value_m = SampledTeam(experiment_, team_, timeline_, experiment_.period_s()).MeetingPoint();
  } else {
    prediction_.value_m = RestingPlace(experiment_, team_, leaders.front());
    const bool moves = !agent(leaders.front()).v_W.head(CountOf(experiment_.law.axes)).isZero(0);
    if (moves || !prediction_.value_m) prediction_.settling_time_s.reset();  // followers settle after the leader
    if (!prediction_.value_m && !team_.agent(leaders.front()).flies) WarnOfLag(leaders.front());
  }
  if (prediction_.value_m && experiment_.law.axes == Axes::kXy)
    prediction_.value_m->z() = HeldHeight(experiment_, team_);
}

/// Takes where agents meet, and when, from a flight in which limits cut: neither is that of the linear team. False,
/// with the reason, if nothing is known.
bool LinearCase::TakeLimited(const FromStart& limited) {
  prediction_.settling_time_s.reset();
  if (team_.Leaders().empty() && FreeRoot() == 0) {  // else all meet at one that does not move
    const Eigen::Index axes = CountOf(experiment_.law.axes);
    if (prediction_.value_m && limited.value_m)
      prediction_.value_m->head(axes) = limited.value_m->head(axes);
    else
      prediction_.value_m.reset();
  }
  if (prediction_.on_average) {
    prediction_.value_m.reset();
    return Silent("a limit cuts what the law asks for, and samples are lost: neither is linear");
  }
  if (limited.agrees) return Silent("a limit cuts what the law asks for, and agents do not stop where they would");
  return limited.settling_time_s ||
         Silent("a limit cuts what the law asks for, and the team, which is flown ahead, does not settle soon");
}

/// Replaces the settling time of the slowest mode by that of the experiment's own start, in which that mode may hardly
/// take part; the rate to measure is that of this start alone.
void LinearCase::PredictFromStart() {
  const std::vector<int> leaders = team_.Leaders();
  const bool leader_stands = leaders.empty() || (agent(leaders.front()).v_W.isZero(0) && prediction_.value_m);
  if (!leader_stands) {
    Silent(fmt::format("agents settle after their leader, agent {}, which does not stand still", leaders.front()));
    return;
  }
  constexpr double kLonger = 3;  // than the slowest mode: along chains agents settle later
  const double settled_s =
      prediction_.slowest_rate_per_s ? kLonger * std::log(50) / *prediction_.slowest_rate_per_s : 0;
  const FromStart from_start =
      FlyFromStart(experiment_, team_, timeline_, std::max(experiment_.run.duration_s, settled_s));
  if (from_start.agrees) {
    prediction_.settling_time_s.reset();
    Silent("agents agree when they start: there is nothing to settle");
  }
  if (from_start.is_cut && !TakeLimited(from_start)) return;
  if (from_start.is_flown && !from_start.agrees) prediction_.response = from_start.response;
  if (!from_start.settling_time_s) {
    if (!prediction_.settling_time_s && prediction_.silent.empty())
      Silent(from_start.is_flown ? "the team, which is flown ahead from its start, does not settle soon"
                                 : "so many agents are not flown ahead from their start for so long");
    return;
  }
  prediction_.from_start = true;
  prediction_.settling_time_s = from_start.settling_time_s;
  prediction_.rate_per_s = from_start.rate_per_s;
}

/// Warns that followers of a leader with constant velocity v stay behind by p_L - p = (b / p) v L_FF^-1 1.
void LinearCase::WarnOfLag(int leader) const {
  if (!IsModal()) return;
  Eigen::MatrixXd pinned = graph_.Laplacian();
  pinned(leader - 1, leader - 1) = 1;
  Eigen::VectorXd ones = Eigen::VectorXd::Ones(pinned.rows());
  ones(leader - 1) = 0;
  const double speed = agent(leader).v_W.head(CountOf(experiment_.law.axes)).norm();
  const double farthest = Solve(pinned, ones).maxCoeff();
  prediction_.warnings.push_back(
      fmt::format("law.leader: the leader keeps its {:.4g} m/s, so followers stay up to {:.4g} m behind", speed,
                  farthest * common_->b / common_->p * speed));
}

/// Why the linear theory does not apply to the team; empty: it does.
std::string WhyNot(const Experiment& experiment, const Linearity& linearity, const Timeline& timeline) {
  if (!linearity.team) return linearity.why_not;
  if (experiment.schedule.range_m() > 0) return "graph.range_m: which agents hear which depends on where they go";
  if (experiment.size() > kLargestSpectrum) return fmt::format("there are more than {} agents", kLargestSpectrum);
  for (const AgentConfig& agent : experiment.agents)
    if (agent.stop_s < experiment.run.duration_s)
      return fmt::format("agents.override.stop_s: agent {} stays behind", agent.id);
  const std::vector<int> leaders = linearity.team->Leaders();
  if (leaders.size() > 1) return AgentList(leaders) + " all lead";
  if (leaders.empty() || !timeline.IsConstant()) return "";
  const std::vector<int> astray =
      NotReached(linearity.team->Followed(timeline.intervals.back().graph), leaders.front());
  return astray.empty() ? "" : fmt::format("agent {} leads, but {} do not hear it", leaders.front(), AgentList(astray));
}

}  // namespace

void PredictLinear(const Experiment& experiment, const Timeline& timeline, Prediction& prediction) {
  if (!prediction.persistence->joint) {  // PersistenceWarnings has said more
    prediction.silent = "the graph has no spanning tree: agents do not agree from every start";
    return;
  }
  const Linearity linearity = LinearTeamOf(experiment);
  prediction.silent = WhyNot(experiment, linearity, timeline);
  if (prediction.silent.empty()) LinearCase(experiment, *linearity.team, timeline, prediction).Predict();
}

}  // namespace mascot
