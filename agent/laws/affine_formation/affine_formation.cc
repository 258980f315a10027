// Affine formation maneuvers; Zhao (2018):
//   follower:  v_i = -gain sum_j omega_ij (p_i - p_j)
//   leader:    v_i = (P_i(t + T) - P_i(t)) / T + leader_gain (P_i(t) - p_i),  P_i(t) = A(t) r_i + b(t)
// The stresses omega_ij of the edges follow from places r and graph (agent/laws/affine_formation/stress_matrix.h):
// Omega r = 0, and Omega is positive semidefinite of rank N - d - 1. If the leaders' places span the plane, or space,
// followers tend to M p_L, M = -Omega_FF^-1 Omega_FL: the affine map of the leaders' places, applied to their own.
// While leaders move, e = p_F - M p_L obeys e+ = (I - T gain Omega_FF) e - M (p_L+ - p_L), which theory computes tick
// by tick.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/affine_formation/affine_theory.h"
#include "agent/laws/affine_formation/maneuver.h"
#include "agent/laws/affine_formation/stress_matrix.h"
#include "agent/laws/parts/leaders.h"
#include "agent/laws/parts/places.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr auto kAffineFormationParameters =
    Joined(Joined(kPlaceKeys, kManeuverKeys),
           std::array{
               kLeadersKey,
               key::Number("gain", {0, 1000}, "slowest rate of the followers").Default("1.0").Unit("1/s").Live(),
           });

constexpr LawFigure kAffineFormationFigures[] = {
    {.name = "place_error_m", .meaning = "how far the farthest follower is from where the leaders put it, at the end"},
    {.name = "largest_place_error_m", .meaning = "the same at its largest in the run"},
};

class AffineFormation final : public Law {
 public:
  AffineFormation(const AgentConfig& agent, double period_s) : period_s_(period_s), id_(agent.id) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<AffineFormationParams>(agent.law); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    if (params_->team.IsLeader(id_))
      return params_->maneuver.Velocity_W(t_s, period_s_, params_->r_W[static_cast<std::size_t>(id_ - 1)], self.p_WB);
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) v_W += params_->gain * params_->omega(id_ - 1, j.id - 1) * (self.p_WB - j.motion.p_WB);
    return v_W;  // omega_ij = -Omega(i, j)
  }

 private:
  const AffineFormationParams* params_ = nullptr;  // the experiment owns them
  double period_s_;
  int id_;
};

std::shared_ptr<const LawParams> ReadAffineFormation(const Experiment& experiment, const LawConfig& law,
                                                     Section& section) {
  auto params = std::make_shared<AffineFormationParams>();
  ExpectNoLeader(law, section);
  params->gain = section.Number("gain");
  params->maneuver = Maneuver::Read(section);
  params->r_W = ReadPlaces(section, experiment.size());
  params->team = LedTeam(ReadLeaders(experiment, section), experiment.size());
  params->omega = ReadStressMatrix(experiment, params->r_W, params->team.leaders, law.axes, section);
  return params;
}

class AffineFormationMeter final : public LawMeter {
 public:
  AffineFormationMeter(const Experiment& experiment, std::span<const int> ids) : id_(ids.front()) { Adopt(experiment); }
  void Adopt(const Experiment& now) override {
    law_ = &now.agent(id_).law;
    shares_ = SharesOfLeaders(params().omega, params().team);
  }
  void Add(const TeamRow& row) override {
    error_m_ = LargestLag(params().team, shares_, law_->axes, row.motions);
    largest_m_ = std::max(largest_m_, error_m_);
  }
  std::vector<FigureValues> Figures() const override { return {{error_m_}, {largest_m_}}; }
  std::optional<double> Curve() const override { return error_m_; }

 private:
  const AffineFormationParams& params() const { return ParamsOf<AffineFormationParams>(*law_); }

  int id_;
  const LawConfig* law_ = nullptr;
  Eigen::MatrixXd shares_;
  double error_m_ = 0, largest_m_ = 0;
};

}  // namespace

LawEntry AffineFormationLaw() {
  return {
      .name = "affine_formation",
      .summary = "a few leaders turn, stretch, shear and shift a whole formation",
      .equation = "follower: v_i = -gain sum_j omega_ij (p_i - p_j);  leader: to P_i(t) = A(t) r_i + b(t)",
      .tex = R"(\text{follower: } v_i = -k \sum_j \omega_{ij} (p_i - p_j) \\
\text{leader: to } P_i(t) = A(t)\, r_i + b(t))",
      .symbols = {{"gain", "k"}, {"offsets_m", "r_i"}},
      .graph =
          "undirected, with a positive semidefinite stress matrix of rank N - d - 1 for places in d dimensions, which "
          "those of the leaders span",
      .details =
          "omega is the stress matrix that projections by turns find, beginning at the identity, or, where they find "
          "none, a semidefinite program, whose answer has the largest smallest eigenvalue, to a tenth of it; it is "
          "scaled so that the smallest eigenvalue of its followers' block is 1. It depends on places and "
          "edges: weights of the graph do not count.\n"
          "Leaders: v_i = (P_i(t + h) - P_i(t)) / h + leader_gain (P_i(t) - p_i).",
      .theory = "p_F tends to -Omega_FF^-1 Omega_FL p_L, the same affine map of the followers' places",
      .source = "Zhao, Affine formation maneuver control of multiagent systems, IEEE Trans. Autom. Control 63 (2018)",
      .parameters = kAffineFormationParameters,
      .figures = kAffineFormationFigures,
      .curve = LawCurve{.name = "place error", .unit = "m", .meaning = "of the farthest follower"},
      .drawing = {.pictures = {}, .hull = kHullOfLeaders<AffineFormationParams>},
      .read = ReadAffineFormation,
      .make = MakeWithPeriod<AffineFormation>,
      .wanted = WantsVelocity,
      .predict = PredictAffineFormation,
      .meter = MeterOf<AffineFormationMeter>};
}

}  // namespace mascot
