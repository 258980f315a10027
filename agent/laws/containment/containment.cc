// Containment: followers go to places among several leaders; Ji, Ferrari-Trecate, Egerstedt & Buffa (2008):
//   follower:  v_i = gain sum_j a_ij (p_j - p_i)
//   leader:    v_i = its own velocity, which may be 0
// With L the Laplacian, split into leaders and followers, p_F tends to M p_L, M = -L_FF^-1 L_FL, if each follower hears
// a leader, directly or not. M has no negative entry and its rows have the sum 1: every follower ends within the convex
// hull of the leaders. Behind leaders with constant velocities v_L it stays the lag (1 / gain) L_FF^-1 M v_L behind
// that place, also if it is sampled, for control periods below min 2 Re(m) / |m|^2 over the eigenvalues m of gain L_FF.
#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "agent/laws/containment/flown_lag.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/leaders.h"
#include "agent/laws/parts/pull.h"
#include "agent/laws/parts/reach.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/stable_period.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

constexpr Key kContainmentParameters[] = {
    key::Number("gain", {0, 1000}, "pull of a follower towards each neighbour, times its weight")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
    kLeadersKey,
    key::Points("leader_velocities_m_per_s", {-1000, 1000},
                "velocity of each leader, in increasing order of their numbers; one: of all leaders; none: they rest")
        .Live(),
};

constexpr LawFigure kContainmentFigures[] = {
    {.name = "lag_m", .meaning = "how far the farthest follower is from its place among the leaders, at the end"},
};

struct ContainmentParams final : LawParams {
  double gain = 0;  ///< 1/s
  LedTeam team{{}, 0};
  Eigen::MatrixX3d v_L_W;  ///< of each leader, one row each (m/s)
};

class Containment final : public Law {
 public:
  explicit Containment(const AgentConfig& agent) : id_(agent.id) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<ContainmentParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const std::vector<int>& leaders = params_->team.leaders;
    const auto leader = std::ranges::lower_bound(leaders, id_);
    if (leader == leaders.end() || *leader != id_) return params_->gain * Pull_W(self, heard);
    return params_->v_L_W.row(leader - leaders.begin()).transpose();
  }

 private:
  const ContainmentParams* params_ = nullptr;  // the experiment owns them
  int id_;
};

Eigen::MatrixX3d ReadLeaderVelocities(std::size_t leaders, Section& section) {
  const auto v_W = section.Points("leader_velocities_m_per_s");
  Eigen::MatrixX3d rows = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(leaders), 3);
  if (v_W.empty() || section.Wrong("leaders") || section.Wrong("leader_velocities_m_per_s")) return rows;
  if (v_W.size() != 1 && v_W.size() != leaders) {
    section.Fail("leader_velocities_m_per_s", "expected one velocity, or one for each of the " +
                                                  std::to_string(leaders) + " leaders, got " +
                                                  std::to_string(v_W.size()));
    return rows;
  }
  for (std::size_t k = 0; k < leaders; ++k)
    rows.row(static_cast<Eigen::Index>(k)) = v_W[v_W.size() == 1 ? 0 : k].transpose();
  return rows;
}

std::shared_ptr<const LawParams> ReadContainment(const Experiment& experiment, const LawConfig& law, Section& section) {
  auto params = std::make_shared<ContainmentParams>();
  ExpectNoLeader(law, section);
  params->gain = section.Number("gain");
  params->team = LedTeam(ReadLeaders(experiment, section), experiment.size());
  params->v_L_W = ReadLeaderVelocities(params->team.leaders.size(), section);
  if (section.Wrong("leaders") || experiment.graph.size() != experiment.size()) return params;
  if (const auto alone = NotReached(experiment.graph, params->team.leaders); !alone.empty())
    section.Fail("leaders",
                 "expected leaders that every other agent hears, directly or not, got none for " + AgentList(alone));
  return params;
}

LawTheory PredictContainment(const Experiment& experiment) {
  const auto& params = ParamsOf<ContainmentParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  if (experiment.size() > kMaxAgentsOfMatrices) return {.silent = "the team is large"};
  if (params.gain == 0) return {.silent = "with gain = 0 followers stay where they are"};
  const Eigen::MatrixXd laplacian = experiment.graph.Laplacian();
  const Eigen::MatrixXd l_FF = BlockOf(laplacian, params.team.followers, params.team.followers);
  if (auto unstable = WhyUnstable(experiment, LongestPeriodOf(params.gain * l_FF))) return *unstable;
  const Eigen::MatrixXd shares = SharesOfLeaders(laplacian, params.team);
  const Eigen::MatrixX3d lag = SolveColumns(l_FF, shares * params.v_L_W) / params.gain;
  const auto flown = FlyToPlaces(experiment, params.team, params.gain, shares, lag);
  if (!flown) return {.silent = "so many agents are not flown ahead for so many ticks"};
  return {.figures = {{.values = {flown->lag_m}}}, .unlimited = true, .holds_from = flown->settled};
}

class ContainmentMeter final : public LawMeter {
 public:
  ContainmentMeter(const Experiment& experiment, std::span<const int> ids) : law_(experiment.agent(ids.front()).law) {
    if (experiment.size() <= kMaxAgentsOfMatrices) shares_ = SharesOfLeaders(experiment.graph.Laplacian(), team());
  }
  void Add(const TeamRow& row) override {
    if (shares_.size() > 0) lag_m_ = LargestLag(team(), shares_, law_.axes, row.motions);
  }
  std::vector<FigureValues> Figures() const override { return {{lag_m_}}; }
  std::optional<double> Curve() const override { return lag_m_; }

 private:
  const LedTeam& team() const { return ParamsOf<ContainmentParams>(law_).team; }

  const LawConfig& law_;
  Eigen::MatrixXd shares_;
  std::optional<double> lag_m_;
};

}  // namespace

LawEntry ContainmentLaw() {
  return {
      .name = "containment",
      .summary = "followers go to places within the convex hull of several leaders, which rest or move",
      .equation = "follower: v_i = gain sum_j a_ij (p_j - p_i);  leader: v_i = its own, 0 by default",
      .tex = R"(\text{follower: } v_i = k \sum_j a_{ij} (p_j - p_i) \\
\text{leader: } v_i = \text{its own velocity, 0 by default})",
      .symbols = {{"gain", "k"}},
      .graph = "each follower hears a leader, directly or by way of other followers",
      .details = "A leader flies its velocity of leader_velocities_m_per_s, and uses nothing of what it hears.",
      .theory =
          "p_F tends to M p_L, M = -L_FF^-1 L_FL, which is in the leaders' hull; leaders with constant velocities are "
          "followed (1/gain) L_FF^-1 M v_L behind",
      .source =
          "Ji, Ferrari-Trecate, Egerstedt & Buffa, Containment control in mobile networks, IEEE Trans. Autom. Control "
          "53 (2008)",
      .parameters = kContainmentParameters,
      .figures = kContainmentFigures,
      .curve = LawCurve{.name = "lag", .unit = "m", .meaning = "of the farthest follower behind its place"},
      .drawing = {.pictures = {}, .hull = kHullOfLeaders<ContainmentParams>},
      .read = ReadContainment,
      .make = MakeOf<Containment>,
      .wanted = WantsVelocity,
      .predict = PredictContainment,
      .meter = MeterOf<ContainmentMeter>};
}

}  // namespace mascot
