#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

// Frameworks: an undirected graph whose agents have places.

/// Above this many agents no rank is computed.
inline constexpr int kMaxAgentsOfRigidity = 200;

/// A pair of agents that hear each other: i < j.
struct Bar {
  int i = 0, j = 0;
  double weight = 1;
};
/// The edges of an undirected graph, each once.
std::vector<Bar> BarsOf(const Graph& graph);
/// The vector from agent i to agent j along `axes`.
Eigen::Vector3d SpanOf(const Bar& bar, std::span<const Eigen::Vector3d> points, Axes axes);
/// The length of a bar along `axes` (m), and its square (m^2).
double LengthOf(const Bar& bar, std::span<const Eigen::Vector3d> points, Axes axes);
double SquareOf(const Bar& bar, std::span<const Eigen::Vector3d> points, Axes axes);

/// A row for each bar, CountOf(axes) columns for each agent: d/dp of half the squares of all lengths.
Eigen::MatrixXd RigidityMatrix(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes);
/// The largest eigenvalue of R'WR, where R is the rigidity matrix and W has the weights of the bars (m^2).
double LargestStiffness(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes);
/// The rank of the rigidity matrix of a shape that its lengths fix against small changes: all motions but those of a
/// rigid body change a length.
int RankOfRigid(int agents, Axes axes);

/// CountOf(axes) rows for each bar: d/dp of all directions. The points of a bar must differ.
Eigen::MatrixXd BearingRigidityMatrix(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes);
/// The rank of the bearing rigidity matrix of a shape that its directions fix, up to its scale: all motions but shifts
/// and scaling change a direction.
int RankOfBearingRigid(int agents, Axes axes);
/// The largest eigenvalue of the sum over bars of weight P(g) / |z|, with P(g) the projection across the bar and |z|
/// its length (1/m).
double LargestTurnStiffness(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes);

/// The message about a graph that is not undirected.
inline constexpr std::string_view kExpectedUndirected =
    "expected a graph in which both agents of an edge hear each other with the same weight, got one without";
/// What must fix the shape of a framework: its lengths, or its directions.
enum class Rigidity { kLengths, kBearings };
/// Notes a mistake in `section`, a law's table without others, unless graph and places suit a law that keeps the shape
/// by lengths or directions. Ranks are left out above kMaxAgentsOfRigidity.
void ExpectRigid(const Experiment& experiment, std::span<const Eigen::Vector3d> places_W, Axes axes, Rigidity rigidity,
                 Section& section);

/// The positions of the whole team, by id - 1.
std::vector<Eigen::Vector3d> PositionsOf(std::span<const Motion> motions);
std::vector<Eigen::Vector3d> StartsOf(const Experiment& experiment);
Eigen::Vector3d CentroidOf(std::span<const Eigen::Vector3d> points);
/// The rms distance from the centroid, along `axes` (m).
double ScaleOf(std::span<const Eigen::Vector3d> points, Axes axes);

}  // namespace mascot
