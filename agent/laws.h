#pragma once

#include <Eigen/Core>
#include <cassert>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/law.h"
#include "experiment/read_experiment.h"

namespace mascot {

/// A law as what theory calls linear, in q = p - d, d being an agent's place (docs/theory.md):
///   wanted acceleration  a_i = sum_j a_ij [p (q_j - q_i) + g (v_j - v_i)] - beta v_i
///   wanted velocity      v_i = p sum_j a_ij (q_j - q_i)
/// or, of a law that does not listen, each agent by itself towards its target w:  a_i = p (w - p_i) - beta v_i
struct LinearForm {
  double p = 0;
  double g = 0;
  double beta = 0;
  bool listens = true;
  bool leader_flies = false;  ///< along waypoints; else a leader's acceleration, or velocity, is 0
};

/// A law in which each child pursues its parent on a tree, with bounded acceleration. By id - 1.
struct PursuitForm {
  std::vector<int> parent;          ///< whom the agent follows; 0 for the root
  std::vector<double> beta;         ///< largest acceleration per axis (m/s^2)
  std::vector<double> parent_beta;  ///< the bound that the agent expects of its parent; 0 for the root
  bool root_flies = false;          ///< along waypoints; else its acceleration is 0
};

/// How pictures show a run of a law: summary.json says it to scripts/plot.py.
struct Drawing {
  std::string_view leader = "leader";          ///< what the agent law.leader is called
  bool switches = false;                       ///< commands jump between limits: single lines would be a blot
  std::span<const std::string_view> pictures;  ///< beside those of positions and velocities
};

/// A row of the table of laws: all that anybody may know of a law. `orchestrator laws` prints the texts. A question
/// without an answer is null.
struct LawEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view equation;
  std::string_view theory;          ///< what is known about it
  std::string_view source;          ///< paper
  std::span<const Key> parameters;  ///< its keys of [law], besides those that all laws have
  Axes axes = Axes::kXy;            ///< default of law.axes
  bool agrees = false;              ///< agents come to agree by what they hear: a spanning tree matters
  bool gathers = false;             ///< brings its agents to one place, where only held heights keep them apart
  Drawing drawing;

  /// Reads and checks the parameters, as LawCatalog::Read.
  std::shared_ptr<const LawParams> (*read)(const Experiment& experiment, const LawConfig& law, Section& section);
  /// Makes the law of agent `id`, which is of this name.
  std::unique_ptr<Law> (*make)(const Experiment& experiment, int id);
  /// What it wants; null: an acceleration.
  Wanted (*wanted)(const LawConfig& law) = nullptr;
  /// d_i: the places in which agents agree, by id - 1.
  std::span<const Eigen::Vector3d> (*places_W)(const LawConfig& law) = nullptr;
  LinearForm (*linear)(const LawConfig& law) = nullptr;
  PursuitForm (*pursuit)(const LawConfig& law) = nullptr;
};

std::span<const LawEntry> Laws();
std::span<const std::string_view> LawNames();
/// The row of a law. Throws std::invalid_argument for a name that is not in the table.
const LawEntry& EntryOf(const LawConfig& law);

// The questions of a row, asked of a law.
Wanted WantedBy(const LawConfig& law);
/// Empty: agents have no places. Valid as long as `law`.
std::span<const Eigen::Vector3d> PlacesOf(const LawConfig& law);
std::optional<LinearForm> LinearFormOf(const LawConfig& law);
std::optional<PursuitForm> PursuitFormOf(const LawConfig& law);

/// The law of agent `id`.
std::unique_ptr<Law> MakeLaw(const Experiment& experiment, int id);

/// Reads a complete experiment with the laws of the table: what `check`, `up` and the agents call. `checked`: it was
/// read before, without a mistake. Throws ConfigError.
Experiment LoadExperiment(Section document, const std::string& default_name, bool checked = false);

/// What a law of this kind has read: for the law's own file.
template <class Params>
const Params& ParamsOf(const LawConfig& law) {
  assert(dynamic_cast<const Params*>(law.params.get()) != nullptr);
  return static_cast<const Params&>(*law.params);
}

}  // namespace mascot
