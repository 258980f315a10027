#include "agent/laws/affine_formation/affine_theory.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "agent/laws/laws.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/stable_period.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

/// Whether one of these agents asks for more speed than it may.
bool AsksForTooMuch(const Experiment& experiment, std::span<const int> ids, const Eigen::MatrixX3d& v_W) {
  for (Eigen::Index k = 0; k < v_W.rows(); ++k)
    if (v_W.row(k).cwiseAbs().maxCoeff() > experiment.agent(ids[static_cast<std::size_t>(k)]).control.max_speed_m_per_s)
      return true;
  return false;
}

}  // namespace

LawTheory PredictAffineFormation(const Experiment& experiment) {
  const auto& params = ParamsOf<AffineFormationParams>(experiment.law);
  if (params.gain == 0) return {.silent = "with gain = 0 followers stay where they are"};
  const LedTeam& team = params.team;
  const Eigen::VectorXd rates =
      SymmetricEigenvalues(params.gain * BlockOf(params.omega, team.followers, team.followers));
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty())
    return {.silent = std::move(why), .rates = LawRates{{rates.begin(), rates.end()}, "law.gain", params.gain}};
  const double h_s = experiment.period_s();
  if (auto unstable = WhyUnstable(experiment, 2 / std::max(rates.maxCoeff(), params.maneuver.gain_per_s())))
    return *unstable;
  if (static_cast<double>(team.followers.size() * team.followers.size()) * static_cast<double>(experiment.ticks()) >
      3e8)
    return {.silent = "so many followers are not flown ahead for so many ticks"};
  // e+ = (I - T gain Omega_FF) e - M (p_L+ - p_L)
  const Eigen::MatrixXd pull = params.gain * BlockOf(params.omega, team.followers, team.followers);
  const Eigen::MatrixXd shares = SharesOfLeaders(params.omega, team);
  const auto along = [&](Eigen::MatrixX3d rows) {
    if (experiment.law.axes == Axes::kXy) rows.col(2).setZero();
    return rows;
  };
  Eigen::MatrixX3d p_L = along(StartsOf(experiment, team.leaders)), v_L = p_L;
  Eigen::MatrixX3d e = along(StartsOf(experiment, team.followers)) - shares * p_L;
  double largest_m = LongestRow(e, Axes::kXyz);
  for (std::int64_t k = 0; k < experiment.ticks(); ++k) {
    for (Eigen::Index l = 0; l < p_L.rows(); ++l) {
      const Eigen::Vector3d& r = params.r_W[static_cast<std::size_t>(team.leaders[static_cast<std::size_t>(l)] - 1)];
      v_L.row(l) = params.maneuver.Velocity_W(experiment.time_s(k), h_s, r, p_L.row(l).transpose());
    }
    v_L = along(v_L);
    const Eigen::MatrixX3d v_F = -pull * e;
    if (AsksForTooMuch(experiment, team.leaders, v_L) || AsksForTooMuch(experiment, team.followers, v_F))
      return {.silent = "a limit cuts the speeds that the law asks for"};
    e += h_s * (v_F - shares * v_L);
    p_L += h_s * v_L;
    largest_m = std::max(largest_m, LongestRow(e, Axes::kXyz));
  }
  return {.figures = Equal({{LongestRow(e, Axes::kXyz)}, {largest_m}})};
}

}  // namespace mascot
