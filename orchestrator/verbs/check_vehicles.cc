#include "orchestrator/verbs/check_vehicles.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <vector>

#include "orchestrator/report/json.h"
#include "orchestrator/verbs/verb.h"
#include "system/standard_streams.h"
#include "system/stop_signal.h"
#include "vehicle/kinds.h"
#include "vehicle/preflight.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kDiscover = 2s, kListen = 3s;

struct Listened {
  int agent = 0;
  std::unique_ptr<Autopilot> vehicle;
  std::int64_t motions = 0;  // at the beginning of kListen
};

double Seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

Json ToJson(const std::vector<PreflightLine>& lines) {
  Json list = Json::array();
  for (const PreflightLine& line : lines) {
    Json place = nullptr;
    if (line.p_W) place = {line.p_W->x(), line.p_W->y(), line.p_W->z()};
    list.push_back({{"agent", line.agent}, {"seen", line.seen}, {"position_m", place}, {"refusals", line.refusals}});
  }
  return list;
}

void Print(const std::vector<PreflightLine>& lines) {
  for (const PreflightLine& line : lines) {
    std::cout << fmt::format("vehicle {:<4} {}\n", line.agent, line.seen);
    for (const std::string& why : line.refusals) std::cout << fmt::format("  refused    {}\n", why);
  }
}

}  // namespace

int CheckVehicles(const Experiment& experiment, bool json) {
  if (AgentsWithVehicles(experiment).empty())
    throw std::invalid_argument("--vehicles: expected an experiment with [[vehicles]], got one without");
  StopSignal stop;
  std::vector<Listened> all;
  for (const int agent : AgentsWithVehicles(experiment)) {
    const VehicleConfig& vehicle = *experiment.agent(agent).vehicle;
    all.push_back(
        {.agent = agent,
         .vehicle = MakeAutopilot({.domain = vehicle.domain, .name = "mascot_check", .address = vehicle.address},
                                  vehicle, [] {})});
  }
  if (const int signal = stop.Within(kDiscover); signal != 0) return 128 + signal;
  for (Listened& one : all) one.motions = one.vehicle->Report().motions;
  if (const int signal = stop.Within(kListen); signal != 0) return 128 + signal;
  std::vector<VehicleSeen> seen;
  for (const Listened& one : all) {
    const VehicleReport report = one.vehicle->Report();
    seen.push_back({.agent = one.agent,
                    .report = report,
                    .rate_hz = static_cast<double>(report.motions - one.motions) / Seconds(kListen),
                    .age_s = Seconds(Clock::now() - report.measured_at)});
  }
  const std::vector<PreflightLine> lines = Preflight(experiment, seen);
  if (json)
    std::cout << ToJson(lines).dump(2) << "\n";
  else
    Print(lines);
  FlushStandardOutput();
  const bool may_fly = std::ranges::all_of(lines, [](const PreflightLine& line) { return line.refusals.empty(); });
  return may_fly ? kExitDone : 1;
}

}  // namespace mascot
