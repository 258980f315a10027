#include "physics_server/process/join_list.h"

#include <algorithm>

#include "experiment/toml/section.h"
#include "physics_server/process/agents_text.h"

namespace mascot {

namespace {
constexpr auto kAskEvery = std::chrono::milliseconds(100);
}  // namespace

JoinList::JoinList(int agents, double start_timeout_s, bool has_vehicles)
    : start_timeout_s_(start_timeout_s), has_vehicles_(has_vehicles), ready_(static_cast<std::size_t>(agents), false) {}

void JoinList::OnAgents(AgentRange agents, bool ready) {
  const int last = std::min(agents.last, static_cast<int>(ready_.size()));
  for (int id = std::max(agents.first, 1); id <= last; ++id) ready_[static_cast<std::size_t>(id - 1)] = ready;
}

void JoinList::OnRecorder(bool ready) { recorder_ready_ = ready; }

void JoinList::Begin(Time now) { begun_ = ask_again_ = now; }

JoinList::Next JoinList::Look(Time now, bool matched) {
  if (matched && IsComplete()) return Next::kStart;
  const bool are_agents_ready = matched && std::ranges::count(ready_, false) == 0;
  const bool waits_for_people = has_vehicles_ && are_agents_ready;
  if (!waits_for_people && now - begun_ >= std::chrono::duration<double>(start_timeout_s_)) return Next::kFail;
  if (now < ask_again_) return Next::kWait;
  ask_again_ = now + kAskEvery;
  return Next::kAsk;
}

bool JoinList::IsComplete() const { return recorder_ready_ && std::ranges::count(ready_, false) == 0; }

std::string JoinList::Missing() const {
  std::vector<int> ids;
  for (std::size_t i = 0; i < ready_.size(); ++i)
    if (!ready_[i]) ids.push_back(static_cast<int>(i) + 1);
  std::string missing = ids.empty() ? "" : AgentsText(ids);
  if (!recorder_ready_) missing += missing.empty() ? "the recorder" : " and the recorder";
  return missing;
}

std::string JoinList::Failure() const {
  return "not ready within run.start_timeout_s = " + ShortestFloat(start_timeout_s_) +
         " s: " + (IsComplete() ? "the wire (readers or writers that have not found each other)" : Missing());
}

}  // namespace mascot
