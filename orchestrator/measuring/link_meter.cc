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
    : experiment_(experiment), said_(experiment.agents.size()), sent_numbers_(experiment.agents.size()) {
  if (!IsPlain(experiment)) CountSamples();
}

/// From now on each sample is followed, because some may not arrive.
void LinkMeter::CountSamples() {
  std::vector<std::vector<double>> messages;  // of which only the size counts
  for (const std::uint64_t numbers : said_) messages.emplace_back(numbers);
  hearing_.emplace(experiment_);
  hearing_->Send(messages);
}

void LinkMeter::Adopt(const std::shared_ptr<const Experiment>& now) {
  if (plain() && !IsPlain(*now)) CountSamples();
  if (hearing_) hearing_->Adopt(now);
}

void LinkMeter::Add(std::int64_t tick, const DecodedRow& row) {
  if (hearing_) {
    hearing_->Hear(tick, row.motions);
    hearing_->Send(row.messages);
    return;
  }
  ++plain_rows_;
  for (std::size_t i = 0; i < said_.size(); ++i) {  // the message sent at tick k - 1 travels with the state of tick k
    sent_numbers_[i] += said_[i];
    said_[i] = row.messages[i].size();
  }
}

void LinkMeter::EdgesNow(std::vector<EdgeNow>& edges) const {
  edges.clear();
  if (plain())
    edges.resize(experiment_.graph.edges(), plain_rows_ > 0 ? EdgeNow{EdgeNow::State::kHeard, 0} : EdgeNow());
  if (hearing_)
    for (const Neighbours& neighbours : hearing_->neighbours()) neighbours.AddEdgesTo(edges);
}

void LinkMeter::LossesSoFar(std::vector<std::uint64_t>& lost) const {
  lost.clear();
  if (hearing_)
    for (const Neighbours& neighbours : hearing_->neighbours()) neighbours.AddLossesTo(lost);
}

std::vector<EdgeTraffic> LinkMeter::Result() const {
  std::vector<EdgeTraffic> traffic;
  for (int id = 1; id <= experiment_.size(); ++id) {
    const auto& may_hear = experiment_.graph.HeardBy(id);
    const auto counts = plain() ? std::vector<EdgeCount>(may_hear.size())
                                : hearing_->neighbours()[static_cast<std::size_t>(id - 1)].counts();
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
