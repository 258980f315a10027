// Consensus and waypoint flight: linear laws, whose modes tell everything.
#include <spdlog/fmt/fmt.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>

#include "agent/laws/consensus.h"
#include "agent/laws/reach.h"
#include "orchestrator/modes.h"
#include "orchestrator/theory_parts.h"

namespace mascot {
namespace {

/// What damps every agent alike, or nothing if it differs: beta, and drag where nobody compensates it.
std::optional<double> CommonDamping(const Experiment& experiment, double beta) {
  std::optional<double> common;
  for (const AgentConfig& agent : experiment.agents) {
    const bool drag = agent.model == "quadrotor" && !agent.control.drag_compensation;
    const double damping = beta + (drag ? agent.airframe.linear_drag_kg_per_s / agent.airframe.mass_kg : 0);
    if (common && *common != damping) return std::nullopt;
    common = damping;
  }
  return common;
}

/// Eigenvalues that must decay: of L without its one zero, or of L without the leader's row and column.
std::vector<std::complex<double>> Spectrum(const Graph& graph, int leader) {
  std::vector<std::complex<double>> spectrum;
  if (leader == 0) {
    const Eigen::VectorXcd all = graph.Eigenvalues();
    spectrum.assign(all.begin() + 1, all.end());
    return spectrum;
  }
  std::vector<Eigen::Index> followers;
  for (int id = 1; id <= graph.size(); ++id) {
    if (id != leader) followers.push_back(id - 1);
  }
  if (followers.empty()) return spectrum;
  const Eigen::MatrixXd grounded = graph.Laplacian()(followers, followers);
  if (graph.IsSymmetric()) {
    const Eigen::VectorXd real =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(grounded, Eigen::EigenvaluesOnly).eigenvalues();
    spectrum.assign(real.begin(), real.end());
  } else {
    const Eigen::VectorXcd complex = Eigen::EigenSolver<Eigen::MatrixXd>(grounded, false).eigenvalues();
    spectrum.assign(complex.begin(), complex.end());
  }
  return spectrum;
}

/// Whether the graph lets the law work at all; says why not.
bool Connected(const Experiment& experiment, Prediction& prediction) {
  const Graph& graph = experiment.graph;
  const int leader = experiment.law.leader;
  if (leader == 0 && graph.Roots().empty()) {
    prediction.warnings.push_back(
        "graph: nobody is heard by everyone, directly or not (no spanning tree), so agents will not all meet");
    return false;
  }
  const std::vector<int> astray = leader == 0 ? std::vector<int>{} : NotReached(graph, leader);
  if (astray.empty()) return true;
  prediction.warnings.push_back(fmt::format(
      "law.leader: leader {} is not heard, directly or not, by {}, who will not follow", leader, AgentList(astray)));
  return false;
}

/// The two gains of a linear law, and what the file calls them.
struct Gains {
  double p = 0;
  double d = 0;
  std::string_view d_key;
};

/// Whether every mode decays, in continuous time and sampled; says what would make it so.
bool Stable(const Experiment& experiment, const Gains& law, const std::vector<LinearMode>& modes,
            Prediction& prediction) {
  if (law.p == 0) {
    prediction.warnings.push_back("law.p_gain: 0 means that nothing pulls an agent anywhere");
    return false;
  }
  if (!std::all_of(modes.begin(), modes.end(), Decays)) {
    double least = 0;
    for (const LinearMode& mode : modes) least = std::max(least, LeastDamping(mode.stiffness));
    const double drag = modes.front().damping - law.d;
    prediction.warnings.push_back(fmt::format("law.{}: unstable, it must be above {:.4g}, got {:.4g}", law.d_key,
                                              std::max(0.0, least - drag), law.d));
    return false;
  }
  const double longest_s = LongestPeriod(modes, experiment.period_s());
  if (longest_s >= experiment.period_s()) return true;
  prediction.warnings.push_back(fmt::format("control.rate_hz: unstable at this rate, it must be above {:.4g}, got {}",
                                            1 / longest_s, experiment.control.rate_hz));
  return false;
}

/// A leader at constant velocity v is followed at p_L - p = (damping / p_gain) v L_FF^-1 1.
void WarnOfLag(const Experiment& experiment, double p_gain, double damping, Prediction& prediction) {
  const double speed = experiment.agent(experiment.law.leader).v_W.head(AxisCount(experiment)).norm();
  Eigen::MatrixXd pinned = experiment.graph.Laplacian();
  const Eigen::Index leader = experiment.law.leader - 1;
  pinned.row(leader).setZero();
  pinned(leader, leader) = 1;
  Eigen::VectorXd ones = Eigen::VectorXd::Ones(pinned.rows());
  ones(leader) = 0;
  const double farthest = pinned.partialPivLu().solve(ones).maxCoeff();
  prediction.warnings.push_back(
      fmt::format("law.leader: the leader keeps its {:.4g} m/s, so followers stay up to {:.4g} m behind", speed,
                  farthest * damping / p_gain * speed));
}

}  // namespace

void PredictConsensus(Experiment& experiment, Prediction& prediction) {
  const ConsensusParams law = ReadConsensus(experiment.law);
  const std::optional<double> damping = CommonDamping(experiment, law.beta);
  const int leader = experiment.law.leader;
  if (!Connected(experiment, prediction) || !damping || experiment.size() > kLargestSpectrum) return;

  std::vector<LinearMode> modes;
  for (const auto& lambda : Spectrum(experiment.graph, leader)) modes.push_back({*damping, law.p_gain * lambda});
  prediction.stable = Stable(experiment, {law.p_gain, law.beta, "beta"}, modes, prediction);
  if (!*prediction.stable) return;

  if (leader > 0) {
    prediction.value_m = RestingLeader(experiment, law.leader_flight.has_value());
    if (!prediction.value_m && !law.leader_flight) WarnOfLag(experiment, law.p_gain, *damping, prediction);
  } else if (const auto gamma = experiment.graph.LeftNullVector(); gamma && *damping > 0) {
    Eigen::Vector3d meeting_m = Eigen::Vector3d::Zero();
    for (const AgentConfig& agent : experiment.agents)
      meeting_m += (*gamma)(agent.id - 1) * (agent.p_W + agent.v_W / *damping);
    prediction.value_m = AtHeldHeight(experiment, meeting_m);
  }
  if (prediction.value_m && !modes.empty()) prediction.settling_time_s = SettlingTime(modes);
}

void PredictWaypoint(Experiment& experiment, Prediction& prediction) {
  const WaypointParams law = ReadWaypoints(experiment.law.section, "");
  const std::optional<double> damping = CommonDamping(experiment, law.d_gain);
  if (!damping) return;
  const std::vector<LinearMode> modes = {{*damping, law.p_gain}};
  prediction.stable = Stable(experiment, {law.p_gain, law.d_gain, "d_gain"}, modes, prediction);
  if (*prediction.stable) prediction.settling_time_s = SettlingTime(modes);
}

}  // namespace mascot
