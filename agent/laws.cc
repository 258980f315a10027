// Every law there is. `orchestrator laws` prints this table.
#include "agent/laws.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include "agent/laws/consensus.h"
#include "agent/laws/custom.h"
#include "agent/laws/formation.h"
#include "agent/laws/minmax.h"
#include "agent/laws/plugin.h"
#include "agent/laws/velocity_consensus.h"
#include "agent/laws/waypoint.h"
#include "experiment/names.h"

namespace mascot {

using LawReader = bool(Experiment& experiment, LawConfig& law);
using LawFactory = std::unique_ptr<Law>(Experiment& experiment, int id);
LawReader CheckConsensus, CheckWaypoint, CheckMinmax, CheckCustom, CheckFormation, CheckVelocityConsensus,
    CheckPlugin;  // each in agent/laws/<name>.cc
LawFactory MakeConsensus, MakeWaypoint, MakeMinmax, MakeCustom, MakeFormation, MakeVelocityConsensus, MakePlugin;

namespace {

constexpr LawEntry kLaws[] = {
    {"consensus", "agents meet, or gather at a leader, by what they hear of their neighbours",
     "a_i = sum_j a_ij [p_gain (p_j - p_i) + v_gain (v_j - v_i)] - beta v_i;  leader: a = 0, or its waypoints",
     "leaderless: meets at g'p(0) + g'v(0) / beta, g the left null vector of L, if a spanning tree exists and "
     "s^2 + (beta + v_gain lambda) s + p_gain lambda is stable for every eigenvalue lambda != 0 of L; "
     "a leader at constant v is followed with a constant lag",
     "Pandit, Njattuvetty, Mulla: MASCOT; Ren & Beard (2008)", kConsensusParameters, Axes::kXy, CheckConsensus,
     MakeConsensus},
    {"waypoint", "every agent flies the same list of waypoints, by arrival or by time",
     "a_i = p_gain (w - p_i) - d_gain v_i",
     "modes s^2 + d_gain s + p_gain; no overshoot from rest for d_gain >= 2 sqrt(p_gain) without limits",
     "Pandit, Njattuvetty, Mulla: MASCOT", kWaypointParameters, Axes::kXyz, CheckWaypoint, MakeWaypoint},
    {"minmax", "min-max time consensus tracking on a spanning tree of the graph",
     "a_c = -beta_c sgn(2 (beta_c - beta_p) z + w |w|),  z = p_c - p_p,  w = v_c - v_p, per axis;  root: a = 0, or its "
     "waypoints",
     "a child meets a resting parent after sqrt(2 z (1/alpha + 1/beta_c)), any parent within 2 sqrt(z / alpha), from "
     "rest, alpha = beta_c - beta_p > 0",
     "Mulla et al. (2017)", kMinmaxParameters, Axes::kXy, CheckMinmax, MakeMinmax},
    {"formation", "agents keep given displacements from each other, alone or behind a leader",
     "a_i = -sum_j a_ij [p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j)] - beta v_i;  leader: a = 0, or its "
     "waypoints",
     "consensus on p_i - d_i: the formation's point meets at the mean of p(0) - d plus that of v(0) / beta "
     "(undirected)",
     "Oh, Park & Ahn (2015); Ren & Atkins (2007)", kFormationParameters, Axes::kXy, CheckFormation, MakeFormation},
    {"velocity_consensus", "single integrators meet: the law wants a velocity", "v_i = p_gain sum_j a_ij (p_j - p_i)",
     "meets at g'p(0), g the left null vector of L, if a spanning tree exists; sampled with period T: p(k+1) = (I - T "
     "p_gain L) p(k), stable for T < 2 / (p_gain lambda_max) (undirected)",
     "Olfati-Saber & Murray (2004)", kVelocityConsensusParameters, Axes::kXy, CheckVelocityConsensus,
     MakeVelocityConsensus},
    {"custom",
     "your own law, in Python: what one agent wants, from what it knows of itself and heard of its neighbours",
     "control(t, me, neighbours) -> [a_x, a_y, a_z] or [a_x, a_y]", "none: check knows only built-in laws",
     "docs/laws.md", kCustomParameters, Axes::kXy, CheckCustom, MakeCustom},
    {"plugin", "your own law, in C++: a shared library that is loaded when the experiment is read",
     "Want_W(t_s, self, heard) -> acceleration or velocity", "none: check knows only built-in laws",
     "docs/plugin_law.md", kPluginParameters, Axes::kXy, CheckPlugin, MakePlugin},
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

const LawEntry& Entry(const std::string& name) {
  const auto* entry = std::ranges::find(kLaws, name, &LawEntry::name);
  if (entry == std::end(kLaws)) throw std::invalid_argument("no law is called \"" + name + "\"");
  return *entry;
}

/// Reads the keys of `law`, a law of some agents. Returns whether it sends messages.
bool ReadParameters(Experiment& experiment, LawConfig& law) {
  const LawEntry& entry = Entry(law.name);
  law.section.Use(entry.parameters);
  return entry.read(experiment, law);
}

/// Each agent's law, and with it whether the agent sends messages.
void ReadLaws(Experiment& experiment) {
  const bool team_sends = ReadParameters(experiment, experiment.law);
  for (AgentConfig& agent : experiment.agents)
    agent.sends_messages = agent.has_own_law ? ReadParameters(experiment, agent.law) : team_sends;
}

}  // namespace

std::span<const LawEntry> Laws() { return kLaws; }

std::span<const std::string_view> LawNames() { return kLawNames; }

std::unique_ptr<Law> MakeLaw(Experiment& experiment, int id) {
  return Entry(experiment.agent(id).law.name).make(experiment, id);
}

Experiment LoadExperiment(Section document, const std::string& default_name, bool checked) {
  const std::vector<std::string_view> xyz_laws = XyzLaws();
  const Vocabulary vocabulary{LawNames(), xyz_laws};
  Experiment experiment = ReadExperiment(document, vocabulary, default_name);
  experiment.checked = checked;
  if (experiment.size() > 0) ReadLaws(experiment);
  Finish(experiment);
  return experiment;
}

}  // namespace mascot
