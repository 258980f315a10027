#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace mascot {

struct Experiment;
struct Prediction;

/// The disagreement (m) over time that theory predicts, as AgreementMeter measures it.
struct Response {
  std::int64_t every = 1;       ///< ticks from one value to the next; the first is of the start
  std::vector<double> value_m;  ///< at most kMaxPoints
  static constexpr std::size_t kMaxPoints = 1024;

  bool operator==(const Response&) const = default;
};

/// Keeps a value of every tick, or of every 2nd, 4th, ..., so that a flight of any length becomes a Response.
class ResponseRecorder {
 public:
  /// Adds the disagreement of the next tick.
  void Add(double disagreement_m);
  Response Take() { return std::move(response_); }

 private:
  Response response_;
  std::int64_t ticks_ = 0;
};

/// A response of a part of a run.
struct PartResponse {
  std::int64_t from = 0;   ///< tick at which the response begins
  std::int64_t until = 0;  ///< tick from which on it does not hold: a phase of [[law.schedule]] or an event begins
  Response response = {};
  bool of_ideal_bodies = false;  ///< not of theory (Prediction::response), but of the agents' laws on ideal bodies
};

/// The responses of the phases of a run, in order of time: theory's, or, of laws by which agents agree, that of ideal
/// bodies (IdealTeam), if it takes at most kMaxIdealSteps. In a phase with events, the response holds until the first
/// event. `prediction` must be that of `experiment`. Phases without a known response have no entry.
std::vector<PartResponse> ResponsesOf(const Experiment& experiment, const Prediction& prediction);

inline constexpr double kMaxIdealSteps = 1e6;  ///< agents and edges times ticks; takes about 0.3 s

}  // namespace mascot
