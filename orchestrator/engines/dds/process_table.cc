#include "orchestrator/engines/dds/process_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/utf8.h"
#include "bus/wire.h"
#include "idl/topics.h"

namespace mascot {

using namespace std::chrono_literals;

namespace {

constexpr auto kBetweenHandOuts = 100ms;
constexpr auto kBetweenHellos = 200ms;

}  // namespace

ProcessTable::ProcessTable(Rules rules) : rules_(std::move(rules)) {}

ProcessTable::News ProcessTable::OnStatus(const std::string& process, const Status& status) {
  const Life life = CheckedLife(status, rules_.last_tick);
  const auto [known, is_new] = statuses_.try_emplace(process);
  const bool changed = is_new || known->second.state() != status.state();
  const bool answers = known->second.request() != status.request();
  known->second = status;
  experiment_wanted_ |= life == Life::kWaiting;
  const auto agents = AgentsOf(process);
  const bool external = agents && rules_.external.at(static_cast<std::size_t>(agents->first - 1));
  if (life == Life::kFailed && external)
    throw std::runtime_error(Plain(process + " failed: " + status.reason().to_string()));
  if (status.experiment() != 0 && status.experiment() != rules_.experiment)
    throw std::runtime_error(
        fmt::format("{} has received another experiment than this run's (digest {:016x}, expected {:016x}): somebody "
                    "else publishes experiments in this DDS domain",
                    process, status.experiment(), rules_.experiment));
  return {.changed = changed, .wake = life == Life::kWaiting || life == Life::kDone || answers};
}

bool ProcessTable::IsTimeToHandOut(Time now) {
  if (now < next_hand_out_ || !std::exchange(experiment_wanted_, false)) return false;
  next_hand_out_ = now + kBetweenHandOuts;
  return true;
}

bool ProcessTable::IsTimeForHello(Time now) {
  if (now < next_hello_) return false;
  next_hello_ = now + kBetweenHellos;
  return true;
}

std::optional<ProcessTable::Status> ProcessTable::Of(const std::string& process) const {
  const auto found = statuses_.find(process);
  if (found == statuses_.end()) return std::nullopt;
  return found->second;
}

bool ProcessTable::HaveTheExperiment() const {
  return std::ranges::all_of(rules_.processes, [this](const std::string& process) {
    const auto found = statuses_.find(process);
    return found != statuses_.end() && found->second.experiment() == rules_.experiment;
  });
}

std::string ProcessTable::Missing() const {
  std::string names;
  for (const std::string& process : rules_.processes)
    if (!statuses_.contains(process)) names += (names.empty() ? "nothing was heard of " : ", ") + process;
  return names.empty() ? "not everybody has found everybody" : names;
}

}  // namespace mascot
