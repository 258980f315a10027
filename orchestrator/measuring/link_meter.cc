#include "orchestrator/measuring/link_meter.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

bool IsAlwaysThere(const AgentConfig& agent) {
  const AgentFaults& faults = agent.faults;
  return agent.start_s == 0 && std::isinf(agent.stop_s) && !faults.is_lost() && !faults.is_mute && !faults.is_deaf &&
         faults.Of(FaultPart::kLink) == nullptr;
}

/// Whether every sample of every edge arrives: perfect links, a constant graph, and every agent there all the time.
bool IsPlain(const Experiment& experiment) {
  return experiment.schedule.IsConstant() && experiment.cut.empty() && experiment.links.ArePerfect(experiment.graph) &&
         std::ranges::all_of(experiment.agents, IsAlwaysThere);
}

}  // namespace

LinkMeter::LinkMeter(const Experiment& experiment)
    : experiment_(experiment),
      plain_(IsPlain(experiment)),
      said_(experiment.agents.size()),
      sent_numbers_(experiment.agents.size()),
      exchange_(experiment) {
  if (!plain_) CountSamples();
}

/// From now on each sample is followed, because some may not arrive.
void LinkMeter::CountSamples() {
  plain_ = false;
  for (const AgentConfig& agent : experiment_.agents) {
    neighbours_.emplace_back(experiment_, agent.id);
    exchange_.Send(agent.id,
                   std::vector<double>(said_[static_cast<std::size_t>(agent.id - 1)]));  // only their number counts
  }
  exchange_.EndTick();
}

void LinkMeter::Adopt(const std::shared_ptr<const Experiment>& now) {
  if (plain_ && !IsPlain(*now)) CountSamples();
  for (Neighbours& neighbours : neighbours_) neighbours.Adopt(*now);
  now_ = now;
}

void LinkMeter::Add(std::int64_t tick, const DecodedRow& row) {
  if (plain_) ++plain_rows_;
  for (const AgentConfig& agent : experiment_.agents) {
    const auto i = static_cast<std::size_t>(agent.id - 1);
    if (plain_) {  // the message sent at tick k - 1 travels with the state of tick k
      sent_numbers_[i] += said_[i];
      said_[i] = row.messages[i].size();
    } else {
      neighbours_[i].Hear(tick, row.motions[i], exchange_.SamplesFor(agent.id, row.motions, samples_));
    }
  }
  if (plain_) return;
  for (const AgentConfig& agent : experiment_.agents)
    exchange_.Send(agent.id, row.messages[static_cast<std::size_t>(agent.id - 1)]);
  exchange_.EndTick();
}

void LinkMeter::EdgesNow(std::vector<EdgeNow>& edges) const {
  edges.clear();
  if (plain_) edges.resize(experiment_.graph.edges(), plain_rows_ > 0 ? EdgeNow{EdgeNow::State::kHeard, 0} : EdgeNow());
  for (const Neighbours& neighbours : neighbours_) neighbours.AddEdgesTo(edges);
}

void LinkMeter::LossesSoFar(std::vector<std::uint64_t>& lost) const {
  lost.clear();
  for (const Neighbours& neighbours : neighbours_) neighbours.AddLossesTo(lost);
}

std::vector<EdgeTraffic> LinkMeter::Result() const {
  std::vector<EdgeTraffic> traffic;
  for (int id = 1; id <= experiment_.size(); ++id) {
    const auto& may_hear = experiment_.graph.HeardBy(id);
    const auto counts =
        plain_ ? std::vector<EdgeCount>(may_hear.size()) : neighbours_[static_cast<std::size_t>(id - 1)].counts();
    for (std::size_t k = 0; k < may_hear.size(); ++k) {
      const auto from = static_cast<std::size_t>(may_hear[k].id - 1);
      EdgeTraffic edge{.hearer = id,
                       .heard = may_hear[k].id,
                       .count = counts[k],
                       .sends_messages = experiment_.agents[from].sends_messages};
      edge.count += {.sent = static_cast<std::uint64_t>(plain_rows_), .numbers = sent_numbers_[from]};
      traffic.push_back(edge);
    }
  }
  return traffic;
}

}  // namespace mascot
