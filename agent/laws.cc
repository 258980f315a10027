// Every law there is. `orchestrator laws` prints this table.
#include "agent/laws.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include "agent/laws/consensus.h"
#include "agent/laws/minmax.h"
#include "agent/laws/waypoint.h"
#include "experiment/names.h"

namespace mascot {

using LawFactory = std::unique_ptr<Law>(Experiment& experiment, int id);
LawFactory MakeConsensus, MakeWaypoint, MakeMinmax;  // each in agent/laws/<name>.cc

namespace {

constexpr LawEntry kLaws[] = {
    {"consensus", "agents meet, or gather at a leader, by what they hear of their neighbours",
     "a_i = p_gain sum_j a_ij (p_j - p_i) - beta v_i;  leader: a = 0, or its waypoints",
     "leaderless: meets at g'p(0) + g'v(0) / beta, g the left null vector of L, if a spanning tree exists and "
     "s^2 + beta s + p_gain lambda is stable for every eigenvalue lambda != 0 of L; "
     "a leader at constant v is followed with a constant lag",
     "Pandit, Njattuvetty, Mulla: MASCOT; Ren & Beard (2008)", kConsensusParameters, Axes::kXy, MakeConsensus},
    {"waypoint", "every agent flies the same list of waypoints, by arrival or by time",
     "a_i = p_gain (w - p_i) - d_gain v_i",
     "modes s^2 + d_gain s + p_gain; no overshoot from rest for d_gain >= 2 sqrt(p_gain) without limits",
     "Pandit, Njattuvetty, Mulla: MASCOT", kWaypointParameters, Axes::kXyz, MakeWaypoint},
    {"minmax", "min-max time consensus tracking on a spanning tree of the graph",
     "a_c = -beta_c sgn(2 (beta_c - beta_p) z + w |w|),  z = p_c - p_p,  w = v_c - v_p, per axis;  root: a = 0, or its "
     "waypoints",
     "a child meets a resting parent after sqrt(2 z (1/alpha + 1/beta_c)), any parent within 2 sqrt(z / alpha), from "
     "rest, alpha = beta_c - beta_p > 0",
     "Mulla et al. (2017)", kMinmaxParameters, Axes::kXy, MakeMinmax},
};

constexpr auto kLawNames = [] {
  std::array<std::string_view, std::size(kLaws)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kLaws[i].name;
  return names;
}();

std::vector<std::string_view> XyzLaws() {
  std::vector<std::string_view> names;
  for (const LawEntry& law : kLaws) {
    if (law.axes == Axes::kXyz) names.push_back(law.name);
  }
  return names;
}

}  // namespace

std::span<const LawEntry> Laws() { return kLaws; }

std::span<const std::string_view> LawNames() { return kLawNames; }

std::unique_ptr<Law> MakeLaw(Experiment& experiment, int id) {
  const auto* entry = std::find_if(std::begin(kLaws), std::end(kLaws),
                                   [&](const LawEntry& law) { return law.name == experiment.law.name; });
  if (entry == std::end(kLaws)) throw std::invalid_argument("no law is called \"" + experiment.law.name + "\"");
  return entry->make(experiment, id);
}

Experiment LoadExperiment(Section document, const std::string& default_name) {
  const std::vector<std::string_view> xyz_laws = XyzLaws();
  const Vocabulary vocabulary{kModelNames, LawNames(), kTransportNames, xyz_laws};
  Experiment experiment = ReadExperiment(document, vocabulary, default_name);
  // A law reads and checks the parameters of all agents, whichever it is made for: one law notes each mistake once.
  if (experiment.size() > 0) MakeLaw(experiment, 1);
  Finish(experiment);
  return experiment;
}

}  // namespace mascot
