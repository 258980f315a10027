#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

// How single integrators that hold a velocity for a control period come together. This is found by flying them ahead,
// tick by tick, from the experiment's own start.

/// Writes into `v_W` what the law wants of each agent at `tick`, in W (m/s), by id - 1; the agents are at `p_W` (m).
using WantedOfAll =
    std::function<void(std::int64_t tick, std::span<const Eigen::Vector3d> p_W, std::span<Eigen::Vector3d> v_W)>;

/// An agent that hears another, by id - 1.
struct HeardEdge {
  std::size_t hearer = 0, heard = 0;
  double weight = 0;
};
std::vector<HeardEdge> EdgesOf(const Graph& graph);

/// What theory says of a team whose law measures the figures of an AgreementTime, in their order, with the tolerance
/// that `share` and `min_m` give. The team is flown, with its limits of speed, to the end of the run, and on until it
/// agrees, but for at most `longest_s`: once as it starts, and twice from starts that are off by up to a nanometre,
/// which shows what rounding decides.
///
/// The predicted time is that of the first flight, if the other two take as long, within two ticks or 1 %. If no time
/// is predicted, a warning says how far apart agents tremble. The predicted distance in the end is at most a tenth,
/// plus the way of one tick, more than in any flight. The meeting point is the mean of all agents at the end of the
/// run, or when they are together if the run ends before; nothing, if rounding moves it by more than the tolerance and
/// the way of one tick. Theory is silent if all this is more work than kMaxFlownEdges.
LawTheory PredictAgreement(const Experiment& experiment, const WantedOfAll& want, double longest_s, double share,
                           double min_m);

inline constexpr double kMaxFlownEdges = 2e7;  ///< edges and agents times ticks, of all three flights

}  // namespace mascot
