#include "orchestrator/sweeping/table/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

constexpr const char* kMetrics[] = {
    "ticks",
    "sim_s",
    "consensus.value_m.x",
    "consensus.value_m.y",
    "consensus.value_m.z",
    "consensus.final_disagreement_m",
    "consensus.final_speed_m_per_s",
    "consensus.settling_time_s",
    "consensus.rate_per_s",
    "consensus.predicted.value_m.x",
    "consensus.predicted.value_m.y",
    "consensus.predicted.value_m.z",
    "consensus.predicted.stable",
    "consensus.predicted.settling_time_s",
    "consensus.predicted.rate_per_s",
    "consensus.predicted.minmax_time_s",
    "consensus.deviation.value_m",
    "consensus.deviation.settling_time_s",
    "consensus.deviation.rate_per_s",
    "consensus.deviation.minmax_time_s",
    "control.effort",
    "control.saturated_fraction",
    "control.tilt_limited_fraction",
    "control.rotor_limited_fraction",
    "safety.min_separation_m",
    "safety.min_separation_along_axes_m",
    "safety.collisions",
    "safety.contacts.agents",
    "safety.contacts.ground",
    "safety.contacts.obstacles",
    "safety.filtered_fraction",
    "safety.infeasible_ticks",
    "safety.predicted.min_separation_m",
    "safety.predicted.min_separation_along_axes_m",
    "formation.final_rms_m",
    "formation.worst_rms_m",
    "links.sent",
    "links.lost",
    "links.late",
    "links.bytes",
    "fidelity.rms_m",
    "fidelity.max_m",
    "fidelity.travelled_m",
};
// Wall-clock times come last: all other columns are reproducible bit by bit.
constexpr const char* kWallClockMetrics[kWallClockColumns] = {"wall_s", "real_time_factor"};

/// The place in summary.json of a column; "value_m.x" is the first entry of a list.
nlohmann::json::json_pointer PlaceOf(std::string name) {
  if (name.ends_with(".x") || name.ends_with(".y") || name.ends_with(".z"))
    name.back() = static_cast<char>('0' + name.back() - 'x');
  std::ranges::replace(name, '.', '/');
  return nlohmann::json::json_pointer("/" + name);
}

/// Appends the columns of a law's own figures.
void AddFigures(const LawEntry& law, std::vector<std::string>& names) {
  for (const char* table : {"", "predicted."})
    for (const LawFigure& figure : law.figures)
      if (figure.each.empty()) names.push_back(fmt::format("laws.{}.{}{}", law.name, table, figure.name));
}

std::string Cell(const nlohmann::json& value) {
  if (value.is_null()) return "";
  if (value.is_number_float()) return ShortestFloat(value.get<double>());
  return value.dump();
}

/// The cell of a figure; empty: it is none that a cell has, or has no value.
struct ToCell {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return std::isfinite(value) ? ShortestFloat(value) : ""; }
  template <class Value>
  std::string operator()(const Value& /*value*/) const {
    return "";
  }
};

}  // namespace

std::vector<std::string> SweepMetricNames(const std::vector<std::string>& laws) {
  std::vector<std::string> names(std::begin(kMetrics), std::end(kMetrics));
  for (const LawEntry& law : Laws())
    if (std::ranges::find(laws, law.name) != laws.end()) AddFigures(law, names);
  names.insert(names.end(), std::begin(kWallClockMetrics), std::end(kWallClockMetrics));
  return names;
}

std::map<std::string, std::string> SweepMetrics(const Figures& figures) {
  std::map<std::string, std::string> cells;
  for (const Figure& figure : figures.all())
    if (std::string cell = std::visit(ToCell(), figure.value); !cell.empty()) cells[figure.name] = std::move(cell);
  return cells;
}

std::map<std::string, std::string> SweepMetrics(const std::string& summary, const std::vector<std::string>& names) {
  const auto json = ReadJson<nlohmann::json>(summary);
  std::map<std::string, std::string> cells;
  for (const std::string& name : names) {
    const nlohmann::json::json_pointer place = PlaceOf(name);
    cells[name] = json.contains(place) ? Cell(json[place]) : "";
  }
  return cells;
}

void CheckColumn(const std::string& option, const std::string& metric, const std::vector<std::string>& metrics) {
  const auto place = std::ranges::find(metrics, metric);
  if (metrics.end() - place > static_cast<std::ptrdiff_t>(kWallClockColumns)) return;
  if (place != metrics.end())
    throw ConfigError({option + ": expected a column of which there are statistics, got '" + metric +
                       "', which depends on the machine"});
  const std::vector<std::string_view> views(metrics.begin(), metrics.end());
  const auto whole =
      std::ranges::find_if(metrics, [&](const std::string& name) { return name.ends_with("." + metric); });
  const auto nearest = whole != metrics.end() ? std::optional(*whole) : DidYouMean(metric, views);
  throw ConfigError({fmt::format("{}: expected a column of the table, such as {}, got '{}'{}", option, kUsualMetric,
                                 metric, nearest ? " (did you mean \"" + *nearest + "\"?)" : "")});
}

}  // namespace mascot
