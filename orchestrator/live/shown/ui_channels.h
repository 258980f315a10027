#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "agent/neighbours.h"
#include "base/flight_phase.h"
#include "experiment/experiment.h"
#include "experiment/toml/key.h"
#include "orchestrator/live/shown/curves.h"
#include "orchestrator/team/row.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

// The messages to the page, as JSON. Distances are in m, times in s, agents by id - 1.

/// Edges beyond which a frame says nothing about them.
inline constexpr std::size_t kMaxEdgesShown = 20000;

/// Agents of which a live key shows their own values.
inline constexpr std::size_t kMaxOwnShown = 100;

/// One tick of a run, as viewers see it.
struct ShownRow {
  explicit ShownRow(int agents) : decoded(agents) {}

  std::int64_t tick = -1;  ///< -1: none yet
  DecodedRow decoded;
  std::vector<EdgeNow> edges;  ///< in increasing order of hearer, then of heard; empty beyond kMaxEdgesShown
  double disagreement_m = 0;
  std::optional<double> curve;  ///< of the team's law (LawEntry::curve)
};

/// How a run goes.
struct RunState {
  enum class Phase { kRunning, kPaused, kDone, kFailed };
  Phase phase = Phase::kRunning;
  /// Simulated seconds per second that the run shall fly; 0: as fast as the machine can.
  double pace = 0;
  double real_time_factor = 0;                 ///< simulated seconds per second that the run flies
  std::optional<std::uint64_t> contacts = {};  ///< absent: not known before the end
};

/// A live key, with its value.
struct ShownKey {
  std::string name;  ///< "law.p_gain"
  Key row;
  std::string value;  ///< of the team, as JSON
  /// As JSON, of each agent that has a value of its own, by the file or by an event (`agents`, `goto`): by id, at most
  /// kMaxOwnShown.
  std::map<int, std::string> own = {};
};

/// An event that has taken effect.
struct ShownEvent {
  std::int64_t number = 0, tick = 0;
  std::string toml = {};
  std::optional<bool> by_hand = {};  ///< absent: it is not known
};

/// What is there of a recording.
struct RecordedPart {
  std::int64_t last_tick = 0;
  std::string run = {};                    ///< the run as verbs take it: the folder or the file, as the user named it
  std::string loss = {};                   ///< why later ticks may be missing; empty: there are none
  std::string incidents = {};              ///< the first lines of the events.csv beside it; empty: there is none
  std::vector<std::string> pictures = {};  ///< names of the pictures beside it
  bool has_summary = false;                ///< whether its summary.json is beside it
};

/// Where rows come from.
struct ShownSource {
  std::string engine = {};                    ///< of a run: "dds" or "inprocess"
  std::optional<RecordedPart> recorded = {};  ///< absent: a run
};

/// What theory says of a run at one time.
struct ShownTheory {
  const Prediction& prediction;                ///< for the phase of that time
  const std::vector<PartResponse>& responses;  ///< of the whole run
  std::int64_t since = 0;                      ///< tick at which the phase has begun
  std::int64_t law_since = 0;                  ///< tick at which the team's law has begun, maybe phases ago
};

/// /ui/experiment
std::string ExperimentJson(const Experiment& experiment, const ShownTheory& theory, const ShownSource& source,
                           const std::vector<ShownKey>& keys);
/// /ui/frame
std::string FrameJson(const Experiment& experiment, const ShownRow& row, const RunState& state);
/// /ui/curves
std::string CurvesJson(const Experiment& experiment, const Curves& curves);
/// /ui/vehicles: of each vehicle, the newest that has happened to it.
std::string VehiclesJson(const std::map<int, VehicleNews>& newest);
/// /ui/events
std::string EventsJson(const Experiment& experiment, const std::vector<ShownEvent>& events);

}  // namespace mascot
