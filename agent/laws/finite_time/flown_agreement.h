#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

// How single integrators come together that hold a velocity for a control period: found out by flying them ahead, tick
// by tick, from the experiment's own start.

/// Writes what the law wants of each agent at `tick`, in W (m/s), by id - 1, where all are at `p_W`.
using WantedOfAll =
    std::function<void(std::int64_t tick, std::span<const Eigen::Vector3d> p_W, std::span<Eigen::Vector3d> v_W)>;

/// An agent that hears another, by id - 1.
struct HeardEdge {
  std::size_t hearer = 0, heard = 0;
  double weight = 0;
};
std::vector<HeardEdge> EdgesOf(const Graph& graph);

/// What theory says of a team whose law measures the figures of an AgreementTime, in their order, with the tolerance
/// that `share` and `least_m` give. The team is flown, with its limits of speed, to the end of the run, and on until it
/// agrees, but for at most `longest_s`: once as it starts, and twice from starts that are off by up to a nanometre,
/// which shows what rounding decides.
///
/// The time is that of the flight, if the others take as long, within two ticks or 1 %. If there is none, a warning
/// says how far apart agents tremble. The distance in the end is at most a tenth, and a tick's way, more than in any
/// flight. The meeting point is the mean of all agents at the end of the run, or when they are together if it ends
/// before; nothing where rounding moves it by more than what counts as together, and a tick's way. Silent if all this
/// is more work than kMostFlownEdges.
LawTheory PredictAgreement(const Experiment& experiment, const WantedOfAll& want, double longest_s, double share,
                           double least_m);

inline constexpr double kMostFlownEdges = 2e7;  ///< edges and agents times ticks, of all three flights

}  // namespace mascot
