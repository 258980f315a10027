#include "agent/laws/parts/rigidity.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <string>

#include "base/linear_algebra.h"

namespace mascot {

std::vector<Bar> BarsOf(const Graph& graph) {
  std::vector<Bar> bars;
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& heard : graph.HeardBy(id))
      if (id < heard.id) bars.push_back({id, heard.id, heard.weight});
  return bars;
}

Eigen::Vector3d SpanOf(const Bar& bar, std::span<const Eigen::Vector3d> points, Axes axes) {
  return Along(axes, points[static_cast<std::size_t>(bar.j - 1)] - points[static_cast<std::size_t>(bar.i - 1)]);
}

double LengthOf(const Bar& bar, std::span<const Eigen::Vector3d> points, Axes axes) {
  return SpanOf(bar, points, axes).norm();
}

double SquareOf(const Bar& bar, std::span<const Eigen::Vector3d> points, Axes axes) {
  return SpanOf(bar, points, axes).squaredNorm();
}

Eigen::MatrixXd RigidityMatrix(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::Index d = CountOf(axes);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(std::ssize(bars), d * std::ssize(points));
  for (std::size_t k = 0; k < bars.size(); ++k) {
    const Eigen::RowVectorXd span = SpanOf(bars[k], points, axes).head(d).transpose();
    matrix.block(static_cast<Eigen::Index>(k), d * (bars[k].i - 1), 1, d) = -span;
    matrix.block(static_cast<Eigen::Index>(k), d * (bars[k].j - 1), 1, d) = span;
  }
  return matrix;
}

double LargestStiffness(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::MatrixXd rigidity = RigidityMatrix(bars, points, axes);
  Eigen::MatrixXd weighted = rigidity;
  for (std::size_t k = 0; k < bars.size(); ++k) weighted.row(static_cast<Eigen::Index>(k)) *= bars[k].weight;
  return SymmetricEigenvalues(rigidity.transpose() * weighted).maxCoeff();
}

int RankOfRigid(int agents, Axes axes) {
  if (agents <= 2) return agents - 1;
  return axes == Axes::kXyz ? 3 * agents - 6 : 2 * agents - 3;
}

Eigen::MatrixXd BearingRigidityMatrix(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::Index d = CountOf(axes);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(d * std::ssize(bars), d * std::ssize(points));
  for (std::size_t k = 0; k < bars.size(); ++k) {
    const Eigen::VectorXd span = SpanOf(bars[k], points, axes).head(d);
    const double length = span.norm();
    assert(length > 0);
    const Eigen::MatrixXd turn =
        (Eigen::MatrixXd::Identity(d, d) - span * span.transpose() / (length * length)) / length;
    matrix.block(d * static_cast<Eigen::Index>(k), d * (bars[k].i - 1), d, d) = -turn;
    matrix.block(d * static_cast<Eigen::Index>(k), d * (bars[k].j - 1), d, d) = turn;
  }
  return matrix;
}

int RankOfBearingRigid(int agents, Axes axes) { return CountOf(axes) * (agents - 1) - 1; }

double LargestTurnStiffness(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::Index d = CountOf(axes);
  const Eigen::MatrixXd turns = BearingRigidityMatrix(bars, points, axes);  // P(g) / |z|
  Eigen::MatrixXd weighted = turns;
  for (std::size_t k = 0; k < bars.size(); ++k)
    weighted.middleRows(d * static_cast<Eigen::Index>(k), d) *= bars[k].weight * LengthOf(bars[k], points, axes);
  return SymmetricEigenvalues(turns.transpose() * weighted).maxCoeff();
}

namespace {

/// "expected ..., got ..."; empty: nothing is wrong.
std::string WhyNotRigid(const Experiment& experiment, std::span<const Eigen::Vector3d> places_W, Axes axes,
                        Rigidity rigidity) {
  const int agents = experiment.size();
  if (agents < 2) return fmt::format("expected at least 2 agents, got {}", agents);
  if (!experiment.graph.IsSymmetric()) return std::string(kExpectedUndirected);
  const std::vector<Bar> bars = BarsOf(experiment.graph);
  for (const Bar& bar : bars)
    if (LengthOf(bar, places_W, axes) == 0)
      return fmt::format("expected two places for agents {} and {}, who hear each other, got one", bar.i, bar.j);
  if (agents > kMaxAgentsOfRigidity) return "";
  const bool by_lengths = rigidity == Rigidity::kLengths;
  const int rank =
      RankOf(by_lengths ? RigidityMatrix(bars, places_W, axes) : BearingRigidityMatrix(bars, places_W, axes));
  const int needed = by_lengths ? RankOfRigid(agents, axes) : RankOfBearingRigid(agents, axes);
  if (rank == needed) return "";
  return fmt::format(
      "expected a graph and places that are infinitesimally {} in {}, got {} {} and a rigidity matrix of rank {}, not "
      "{}",
      by_lengths ? "rigid" : "bearing rigid", axes == Axes::kXyz ? "space" : "the plane", bars.size(),
      bars.size() == 1 ? "pair" : "pairs", rank, needed);
}

}  // namespace

void ExpectRigid(const Experiment& experiment, std::span<const Eigen::Vector3d> places_W, Axes axes, Rigidity rigidity,
                 Section& section) {
  if (section.Wrong("") || experiment.checked || experiment.graph.size() != experiment.size()) return;
  if (const std::string why = WhyNotRigid(experiment, places_W, axes, rigidity); !why.empty())
    section.Fail("name", why);
}

Eigen::Vector3d CentroidOf(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

double ScaleOf(std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::Vector3d centre = CentroidOf(points);
  double squares = 0;
  for (const Eigen::Vector3d& p : points) squares += Along(axes, p - centre).squaredNorm();
  return std::sqrt(squares / static_cast<double>(points.size()));
}

std::vector<Eigen::Vector3d> PositionsOf(std::span<const Motion> motions) {
  std::vector<Eigen::Vector3d> positions;
  for (const Motion& motion : motions) positions.push_back(motion.p_WB);
  return positions;
}

std::vector<Eigen::Vector3d> StartsOf(const Experiment& experiment) {
  std::vector<Eigen::Vector3d> starts;
  for (const AgentConfig& agent : experiment.agents) starts.push_back(agent.p_W);
  return starts;
}

}  // namespace mascot
