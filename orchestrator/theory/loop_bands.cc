// A figure is measured, by the law's own meter, on five flights of LowLevelLoops: by the airframe's gains, and with
// bodies that turn and accelerate somewhat less or more. The band reaches to both sides of the first by kTimes the
// range of all, and by a floor more. So figures that hang on what the model leaves out get wide bands; too wide ones
// are not told.
#include "orchestrator/theory/loop_bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/theory/flight_envelope.h"
#include "orchestrator/theory/links_on_average.h"
#include "orchestrator/theory/loop_team.h"
#include "orchestrator/theory/stack_rate.h"

namespace mascot {
namespace {

constexpr double kTimes = 1.5;
constexpr double kWidest = 0.5;                               // share of the value
constexpr double kFloorShare = 0.01, kFloorShareOfCut = 0.1;  // the latter where the limit of the tilt has cut
// For times at which something is passed for the last time: a swing that dies out may pass it again a period later.
constexpr double kFloorShareOfTimes = 0.1;
// For what is counted, where it is more than a few.
constexpr double kCounted = 3, kFloorOfCounts = 2, kFloorShareOfCounts = 0.03;

constexpr double kQuadrotorTurn = 0.05, kQuadrotorPush = 0.01, kOtherPush = 0.001;
constexpr std::array<LoopError, 4> kErrors = {
    {{.turn = 1, .push = 1}, {.turn = -1, .push = -1}, {.turn = 0.5, .push = -0.5}, {.turn = -0.5, .push = 0.5}}};

/// The figures of all flights, and why there are none.
struct Flights {
  std::string silent;
  std::vector<LoopFlight> flown;
};

bool Lags(const AgentConfig& agent) {
  return agent.traits().has_airframe ||
         (agent.traits().driven_by == Wanted::kAcceleration && WantedBy(agent.law) == Wanted::kVelocity);
}

bool Says(const PredictedFigure& figure) {
  return std::ranges::any_of(figure.values, [](const std::optional<double>& value) { return value.has_value(); });
}

std::string OfAgent(const Experiment& experiment, const AgentConfig& agent) {
  if (agent.traits().rolls) return "a unicycle turns before it goes where it is wanted";
  if (!agent.traits().has_airframe) return "";
  if (experiment.phase > 0) return "how quadrotors are tilted when a later phase begins is not predicted";
  if (std::abs(std::remainder(agent.control.heading_rad - agent.heading_rad, 2 * std::numbers::pi)) > 1e-3)
    return fmt::format("agent {} turns to control.heading_rad on its way", agent.id);
  return "";
}

/// How far bodies may be from their model: where they are quadrotors, the model leaves out more.
LoopError Scaled(const LoopError& share, const Experiment& experiment) {
  const bool quadrotors =
      std::ranges::any_of(experiment.agents, [](const AgentConfig& agent) { return agent.traits().has_airframe; });
  return {.turn = quadrotors ? kQuadrotorTurn * share.turn : 0,
          .push = (quadrotors ? kQuadrotorPush : kOtherPush) * share.push};
}

/// All flights, that of the model first; none, and why, if one is silent.
Flights Fly(const Experiment& experiment) {
  Flights flights;
  flights.flown.push_back(FlyLoops(experiment, {.turn = 0, .push = 0}));
  if (flights.flown.front().silent.empty())
    for (LoopFlight& flight : FlyBeside(experiment, [](const LoopFlight& one) { return one.silent.empty(); }))
      flights.flown.push_back(std::move(flight));
  if (!flights.flown.back().silent.empty()) return {.silent = std::move(flights.flown.back().silent), .flown = {}};
  return flights;
}

/// The values of entry `k` of figure `figure`, of all flights; empty if one has none.
std::vector<double> ValuesOf(const Flights& flights, std::size_t figure, std::size_t k) {
  std::vector<double> values;
  for (const LoopFlight& flight : flights.flown) {
    const FigureValues& of_flight = flight.figures[figure];
    if (k >= of_flight.size() || !of_flight[k] || !std::isfinite(*of_flight[k])) return {};
    values.push_back(*of_flight[k]);
  }
  return values;
}

/// Whether entry `k` of figure `figure` has a value on no flight.
bool NobodyHas(const Flights& flights, std::size_t figure, std::size_t k) {
  return std::ranges::none_of(flights.flown, [&](const LoopFlight& flight) {
    const FigureValues& of_flight = flight.figures[figure];
    return k < of_flight.size() && of_flight[k];
  });
}

/// What a figure may be off by in any case, from the unit in its name, or if it counts something. `is_tilt_cut`: then
/// lengths that differ between flights are known less.
double Floor(std::string_view name, std::span<const double> values, double period_s, bool is_tilt_cut) {
  const double size = std::abs(values.front());
  if (name.ends_with("_time_s")) return 3 * period_s + kFloorShareOfTimes * size;
  if (name.ends_with("_deg")) return 0.05 + kFloorShare * size;
  const bool counts = std::ranges::all_of(values, [](double value) { return value == std::round(value); });
  if (counts && std::ranges::max(values) > kCounted) return kFloorOfCounts + kFloorShareOfCounts * size;
  const bool differ = std::ranges::min(values) < std::ranges::max(values);
  return 0.002 + (is_tilt_cut && differ && name.ends_with("_m") ? kFloorShareOfCut : kFloorShare) * size;
}

constexpr std::string_view kWide = "it hangs on more than is known of the bodies";
constexpr std::string_view kNone = "bodies that lag do not come to it by the end of the run";

/// The band of figure `figure`; without some or all values, and with the reason, if there is none or a wide one.
PredictedFigure Band(const Flights& flights, std::size_t figure, std::string_view name, double period_s) {
  PredictedFigure band{.bound = Bound::kWithin};
  for (std::size_t k = 0; k < flights.flown.front().figures[figure].size(); ++k) {
    std::optional<double> value, tolerance;
    const std::vector<double> values = ValuesOf(flights, figure, k);
    if (!values.empty()) {
      const auto [least, most] = std::ranges::minmax(values);
      const double floor = Floor(name, values, period_s, flights.flown.front().is_tilt_cut),
                   width = kTimes * (most - least) + floor;
      if (width <= std::max(kWidest * std::abs(values.front()), 3 * floor)) value = values.front(), tolerance = width;
    }
    if (!value) band.why = values.empty() && NobodyHas(flights, figure, k) ? kNone : kWide;
    band.values.push_back(value);
    band.tolerances.push_back(tolerance);
  }
  return Says(band) ? band : NotPredicted(band.why);
}

}  // namespace

std::vector<LoopFlight> FlyBeside(const Experiment& experiment, const std::function<bool(const LoopFlight&)>& goes_on) {
  std::vector<LoopFlight> flights;
  for (const LoopError& share : kErrors) {
    flights.push_back(FlyLoops(experiment, Scaled(share, experiment)));
    if (!goes_on(flights.back())) break;
  }
  return flights;
}

std::string WhyNotLoops(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents)
    if (std::string why = OfAgent(experiment, agent); !why.empty()) return why;
  if (experiment.run.mode == Mode::kRealtime) return "in real time commands may come late";
  if (!experiment.sensors.own.IsNone() || !experiment.sensors.heard.IsNone() || experiment.sensors.own_delay_s > 0)
    return "what agents measure is noisy or late";
  if (LosesSome(experiment)) return "samples are lost at random";
  if (std::string random = RandomAge(experiment); !random.empty()) return random;
  if (experiment.physics.wind.gust_std_m_per_s > 0) return "the wind has gusts";
  if (!experiment.physics.rotor_failures.empty()) return "rotors fail";
  if (!LiftWarnings(experiment).empty()) return "quadrotors cannot keep their height";
  if (WorkOfLoops(experiment) > kMaxLoopWork)
    return "so many agents, edges and ticks are more than are flown ahead on lagging bodies";
  return "";
}

void PredictOnLoops(const Experiment& experiment, Prediction& prediction) {
  const LawEntry& law = EntryOf(experiment.law);
  if (law.meter == nullptr || law.predict == nullptr || std::ranges::none_of(experiment.agents, Lags)) return;
  if (prediction.safety || std::ranges::any_of(experiment.agents, [](const AgentConfig& agent) {
        return agent.has_own_law || agent.law.since < 0;
      }))
    return;  // theory has said why it is silent
  std::vector<PredictedFigure>& told = prediction.law_figures;
  if (!told.empty() && std::ranges::all_of(told, Says)) return;
  const auto silent = [&](std::string why) {
    if (told.empty()) (prediction.silent.empty() ? prediction.figures_silent : prediction.silent) = std::move(why);
  };
  if (FindUnstableLoop(experiment)) return;  // it has said so
  if (std::string why = WhyNotLoops(experiment); !why.empty()) return silent(std::move(why));
  const Flights flights = Fly(experiment);
  if (!flights.silent.empty()) return silent(flights.silent);
  std::vector<PredictedFigure> bands;
  for (std::size_t k = 0; k < law.figures.size(); ++k)
    bands.push_back(Band(flights, k, law.figures[k].name, experiment.period_s()));
  if (std::ranges::none_of(bands, Says))
    return silent(fmt::format("{}: {}", law.figures.front().name, bands.front().why));
  const bool closed_forms = !told.empty();
  told.resize(bands.size());
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (!Says(told[k]) && (Says(bands[k]) || !closed_forms)) told[k] = std::move(bands[k]);
  prediction.silent.clear();
  prediction.figures_silent.clear();
}

}  // namespace mascot
