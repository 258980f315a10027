#include "orchestrator/sweeping/metrics.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

// JSON pointer of each column in summary.json. Wall-clock times come last: all other columns are reproducible bit by
// bit.
constexpr const char* kMetrics[] = {
    "/ticks",
    "/sim_s",
    "/consensus/value_m/0",
    "/consensus/value_m/1",
    "/consensus/value_m/2",
    "/consensus/final_disagreement_m",
    "/consensus/final_speed_m_per_s",
    "/consensus/settling_time_s",
    "/consensus/rate_per_s",
    "/consensus/predicted/value_m/0",
    "/consensus/predicted/value_m/1",
    "/consensus/predicted/value_m/2",
    "/consensus/predicted/stable",
    "/consensus/predicted/settling_time_s",
    "/consensus/predicted/rate_per_s",
    "/consensus/predicted/minmax_time_s",
    "/consensus/deviation/value_m",
    "/consensus/deviation/settling_time_s",
    "/consensus/deviation/rate_per_s",
    "/consensus/deviation/minmax_time_s",
    "/control/effort",
    "/control/saturated_fraction",
    "/control/tilt_limited_fraction",
    "/control/rotor_limited_fraction",
    "/safety/min_separation_m",
    "/safety/collisions",
    "/safety/contacts/agents",
    "/safety/contacts/ground",
    "/safety/contacts/obstacles",
    "/formation/final_rms_m",
    "/formation/worst_rms_m",
    "/links/sent",
    "/links/lost",
    "/links/late",
    "/links/bytes",
    "/fidelity/rms_m",
    "/fidelity/max_m",
    "/fidelity/travelled_m",
    "/wall_s",
    "/real_time_factor",
};

std::string Cell(const nlohmann::json& value) {
  if (value.is_null()) return "";
  if (value.is_number_float()) return ShortestFloat(value.get<double>());
  return value.dump();
}

}  // namespace

std::vector<std::string> SweepMetricNames() {
  std::vector<std::string> names;
  for (const char* pointer : kMetrics) {
    std::string name = pointer + 1;
    std::ranges::replace(name, '/', '.');
    if (name.back() >= '0' && name.back() <= '2') name.back() = "xyz"[name.back() - '0'];
    names.push_back(name);
  }
  return names;
}

std::vector<std::string> SweepMetrics(const std::string& summary) {
  const nlohmann::json json = nlohmann::json::parse(summary);
  std::vector<std::string> cells;
  for (const char* pointer : kMetrics) {
    const nlohmann::json::json_pointer place(pointer);
    cells.push_back(json.contains(place) ? Cell(json[place]) : "");
  }
  return cells;
}

}  // namespace mascot
