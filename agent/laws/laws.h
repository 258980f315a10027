#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/laws/law.h"
#include "agent/laws/law_figures.h"
#include "agent/laws/parts/observation.h"
#include "experiment/read_experiment.h"

namespace mascot {

/// A linear law as theory sees it, in q = p - d, where d is the agent's place in the formation (docs/theory.md):
///   wanted acceleration  a_i = sum_j a_ij [p (q_j - q_i) + g (v_j - v_i)] - beta v_i
///   wanted velocity      v_i = p sum_j a_ij (q_j - q_i)
/// For a law that does not listen, each agent goes to its target w by itself:  a_i = p (w - p_i) - beta v_i
struct LinearForm {
  double p = 0;     ///< 1/s^2; 1/s if the law wants a velocity
  double g = 0;     ///< 1/s
  double beta = 0;  ///< 1/s
  bool listens = true;
  bool leader_flies = false;  ///< the leader flies waypoints; else its acceleration, or velocity, is 0
};

/// A law in which each agent pursues its parent in a tree with bounded acceleration. Vectors are by id - 1.
struct PursuitForm {
  std::vector<int> parent;          ///< the agent that this one follows; 0 for the root
  std::vector<double> beta;         ///< largest acceleration per axis (m/s^2)
  std::vector<double> parent_beta;  ///< the bound that the agent assumes for its parent; 0 for the root
  bool root_flies = false;          ///< the root flies waypoints; else its acceleration is 0
  bool switches = true;             ///< accelerations jump between -beta and beta, up to the end
};
/// A child has caught up with its parent when they are at most this far apart along each axis of the law (m).
inline constexpr double kCaughtUp_m = 0.05;

/// The picture (Drawing::pictures) that shows how fast agents agree.
inline constexpr std::string_view kDisagreementPicture[] = {"disagreement"};

/// A key of a law whose value is drawn. Scripts read the key in config.toml; this program asks `of`.
template <class Item>
struct DrawnKey {
  std::string_view key = {};                                    ///< empty: the law has no such key
  std::span<const Item> (*of)(const LawConfig& law) = nullptr;  ///< the value, valid as long as `law`; null: no key
};

/// How runs of a law are drawn: summary.json passes it to scripts/plot.py, /ui/experiment to the page.
struct Drawing {
  std::string_view leader = "leader";          ///< word for the agent law.leader
  bool switches = false;                       ///< commands jump between limits: show their moving mean, too
  std::span<const std::string_view> pictures;  ///< pictures besides positions and velocities
  std::string_view telling = "paths";          ///< the picture that shows most of the law: docs/laws.md has it
  DrawnKey<int> hull = {};                     ///< the agents whose convex hull is drawn, in increasing id
  DrawnKey<Eigen::Vector2d> cells = {};        ///< corners, in x and y of W (m), counterclockwise, of a convex region
                                               ///< that agents divide by nearness
};

/// A letter of a typeset equation that stands for a key of the law.
struct KeySymbol {
  std::string_view key, tex;
};

/// A row of the table of laws: everything that other libraries may know about a law. `orchestrator laws` prints the
/// texts. Each law's file in agent/laws/ makes its own row; agent/laws/laws.cc lists them.
struct LawEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view equation;
  /// The equation as TeX, for the documentation and the handout: formulas, which `\\` separates.
  std::string_view tex;
  std::vector<KeySymbol> symbols = {};
  /// The graph that the law needs for what theory says of it, in words.
  std::string_view graph;
  /// What the program does that the equation leaves out, one paragraph in each line. Empty: nothing.
  std::string_view details = {};
  std::string_view theory;                  ///< known results on convergence
  std::string_view source;                  ///< paper
  std::span<const Key> parameters;          ///< its own keys in [law], besides LawKeys()
  std::span<const LawFigure> figures = {};  ///< what it measures beyond the figures that all laws share
  std::optional<LawCurve> curve = {};       ///< absent: disagreement tells most
  Axes axes = Axes::kXy;                    ///< default of law.axes
  bool is_driven = false;                   ///< somebody outside decides, and gives its agents actions
  bool agrees = false;                      ///< agents agree by what they hear, which needs a spanning tree
  bool gathers = false;                     ///< agents meet in one place, where only their heights keep them apart
  bool is_of_user = false;                  ///< it runs code that a user of this program has written
  std::string_view seeded = {};             ///< what such code is to draw random numbers from, in words for warnings
  /// The law uses what the agent sees of obstacles (Law::See), to keep clear of them.
  bool sees_obstacles = false;
  Drawing drawing;

  /// Reads and checks the parameters, as LawCatalog::Read() does.
  std::shared_ptr<const LawParams> (*read)(const Experiment& experiment, const LawConfig& law, Section& section);
  /// Makes the law of agent `id`, whose law.name is this row's.
  std::unique_ptr<Law> (*make)(const Experiment& experiment, int id);
  /// Whether the law may draw random numbers by run.seed; null: it draws none.
  bool (*draws)(const LawConfig& law) = nullptr;
  /// What is to be said of parameters in the file that the law, which has been flown, has not looked up; null: nothing.
  std::vector<std::string> (*unread)(const LawConfig& law) = nullptr;
  /// What the law wants; null: an acceleration.
  Wanted (*wanted)(const LawConfig& law) = nullptr;
  /// d_i: each agent's place in the formation, in W (m), by id - 1; null: no places.
  std::span<const Eigen::Vector3d> (*places_W)(const LawConfig& law) = nullptr;
  /// The parameters, with their values, that make an agent fly to `p_W` (m) from `t_s` on, in place of its waypoints;
  /// empty for an agent that flies no waypoints. Null: no agent with this law flies waypoints.
  std::map<std::string, Value> (*go_to)(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) = nullptr;
  /// The targets of an agent, in W (m); only the leader has some, if there is a leader. Null: no agent has targets.
  std::span<const Eigen::Vector3d> (*waypoints_W)(const AgentConfig& agent) = nullptr;
  /// What the law leaves out: for each entry of `heard`, the axes along which it is not used, bit k for axis k. `self`
  /// and `heard` are as for Law::Want_W(). Null: the law uses all that it hears.
  std::vector<std::uint8_t> (*left_out)(const LawConfig& law, const Motion& self,
                                        std::span<const Heard> heard) = nullptr;
  /// F: so many of those that an agent hears may lie, because the law leaves out as many of the farthest on either
  /// side. Null: it believes all that it hears.
  std::size_t (*liars_left_out)(const LawConfig& law) = nullptr;
  /// What the law's agents perceive as a row of numbers, which a file of the law was made for. Null: no such row.
  const ObservationLayout& (*observation)(const LawConfig& law) = nullptr;
  /// Null: the law is not linear.
  LinearForm (*linear)(const LawConfig& law) = nullptr;
  /// Null: the law is not a pursuit on a tree.
  PursuitForm (*pursuit)(const LawConfig& law) = nullptr;
  /// Predicts the figures, for an experiment without events in which no agent has a law of its own. Null: theory
  /// predicts nothing.
  LawTheory (*predict)(const Experiment& experiment) = nullptr;
  /// Makes the meter of the figures, over the agents `ids` (increasing, at least one), whose law.name is this row's.
  /// The experiment must outlive the meter. Null: the law has no figures.
  std::unique_ptr<LawMeter> (*meter)(const Experiment& experiment, std::span<const int> ids) = nullptr;
};

std::span<const LawEntry> Laws();
/// The rows of the laws that agents of the experiment fly, in the order in which they first appear.
std::vector<const LawEntry*> LawsIn(const Experiment& experiment);
/// Whether agents fly a law that runs code of a user, at the start or later.
bool FliesCodeOfUsers(const Experiment& experiment);
/// Warnings of parameters that the laws at the start, flown from this very object or from copies of it, have not looked
/// up so far, each once.
std::vector<std::string> UnreadParams(const Experiment& experiment);
/// Whether agents fly a law that leaves out some of what it hears (LawEntry::left_out), at the start or later.
bool EverLeavesOut(const Experiment& experiment);
/// LawEntry::details, paragraph by paragraph.
std::vector<std::string_view> DetailsOf(const LawEntry& law);
/// LawEntry::tex, formula by formula.
std::vector<std::string> FormulasOf(const LawEntry& law);
/// The agents that fly `law`, in increasing id.
std::vector<int> AgentsWith(const LawEntry& law, const Experiment& experiment);
std::span<const std::string_view> LawNames();
/// The row of a law. Throws std::invalid_argument for a name that is not in the table.
const LawEntry& EntryOf(const LawConfig& law);

// What the row of a law says about it. They throw as EntryOf() does.
Wanted WantedBy(const LawConfig& law);
/// True if the agent's law wants a velocity and its model is driven by one: no acceleration is commanded.
bool IsCommandedByVelocity(const AgentConfig& agent);
/// Each agent's place in the formation, in W (m), by id - 1; empty: no places. Valid as long as `law`.
std::span<const Eigen::Vector3d> PlacesOf(const LawConfig& law);
/// The targets to which this agent flies, in W (m); empty: it flies to none. Valid as long as `agent`.
std::span<const Eigen::Vector3d> WaypointsOf(const AgentConfig& agent);
/// The agents among which this law keeps the others: Drawing::hull; empty: none. Valid as long as `law`.
std::span<const int> HullOf(const LawConfig& law);
/// The region that agents with this law divide: Drawing::cells; empty: none. Valid as long as `law`.
std::span<const Eigen::Vector2d> RegionOf(const LawConfig& law);
std::optional<LinearForm> LinearFormOf(const LawConfig& law);
/// LawEntry::liars_left_out; nullopt: the law believes all that it hears.
std::optional<std::size_t> LiarsLeftOutBy(const LawConfig& law);
std::optional<PursuitForm> PursuitFormOf(const LawConfig& law);

/// The layouts of the rows of numbers that agents perceive at the start (LawEntry::observation), in the order in which
/// they first appear, and the agents of each, in increasing id.
struct Perceived {
  ObservationLayout layout;
  std::vector<int> ids;
};
std::vector<Perceived> PerceivedIn(const Experiment& experiment);

/// Makes the law of agent `id`. The experiment must outlive it. Throws std::logic_error if it is a user's, and the
/// experiment was read with UserCode::kNeverRuns.
std::unique_ptr<Law> MakeLaw(const Experiment& experiment, int id);

/// The table of laws, for readers of experiments.
const LawCatalog& LawTable();
/// Reads a complete experiment with the laws of the table. `checked`: it was read before, without a mistake, so slow
/// checks are left out. Throws ConfigError with all mistakes.
Experiment LoadExperiment(Section document, const std::string& default_name, bool checked = false,
                          UserCode user_code = UserCode::kMayRun);
/// Reads `text`, the contents of the file `path`, with `overrides` in place of its keys. The name of the file is the
/// default of run.name. For a mistake that the file alone does not have, the message names the override that made it.
Experiment LoadExperiment(const std::string& text, const std::string& path, std::span<const Override> overrides,
                          UserCode user_code = UserCode::kMayRun);

/// The parameters of `law` as the type that its own file in agent/laws/ defines.
template <class Params>
const Params& ParamsOf(const LawConfig& law) {
  assert(dynamic_cast<const Params*>(law.params.get()) != nullptr);
  return static_cast<const Params&>(*law.params);
}

}  // namespace mascot
