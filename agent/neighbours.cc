#include "agent/neighbours.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace mascot {

bool IsOn(const AgentConfig& agent, double t_s) {
  constexpr double kRounding_s = 1e-9;  // tolerance for rounding: times are ticks divided by the rate
  return t_s >= agent.start_s - kRounding_s && t_s < agent.stop_s - kRounding_s && !agent.faults.is_lost();
}

Neighbours::Neighbours(const Experiment& experiment, int id)
    : experiment_(&experiment), id_(id), may_hear_(experiment.graph.HeardBy(id)) {
  heard_.reserve(may_hear_.size());
  edge_states_.resize(may_hear_.size());
  early_counts_.resize(may_hear_.size());
  plain_ = IsPlain();
  if (!plain_) MakeChannels();
}

void Neighbours::MakeChannels() {
  const Experiment& experiment = *experiment_;
  channels_.reserve(may_hear_.size());
  for (std::size_t k = 0; k < may_hear_.size(); ++k) {
    const int heard = may_hear_[k].id;
    channels_.push_back(
        {.link = Link(experiment.links.Of(id_, heard), experiment.control.rate_hz, experiment.run.seed, id_, heard),
         .noise = Noise(experiment.sensors.heard,
                        Dice(experiment.run.seed, Dice::Stream::kHeardSensor, static_cast<std::uint64_t>(id_),
                             static_cast<std::uint64_t>(heard)))});
    AdoptIn(k);
  }
}

void Neighbours::AdoptIn(std::size_t k) {
  const Experiment& experiment = *experiment_;
  const AgentConfig& sender = experiment.agent(may_hear_[k].id);
  Channel& channel = channels_[k];
  channel.false_data.reset();
  if (sender.lie) channel.false_data.emplace(*sender.lie, experiment.run.seed, sender.id);
  const PartFault* fault = sender.faults.Of(FaultPart::kLink);
  if (fault == nullptr)
    channel.faulty.reset();
  else if (!channel.faulty || channel.faulty->since() != fault->since)
    channel.faulty.emplace(*fault, experiment.control.rate_hz, experiment.run.seed);
  channel.link.Adopt(experiment.links.Of(id_, sender.id), channel.faulty ? channel.faulty->delay_s() : 0);
}

void Neighbours::Adopt(const Experiment& experiment) {
  const bool is_fresh = experiment.agent(id_).faults.restarted != experiment_->agent(id_).faults.restarted;
  experiment_ = &experiment;
  if (is_fresh) {
    for (std::size_t k = 0; k < channels_.size(); ++k) early_counts_[k] += channels_[k].link.count();
    channels_.clear();
    plain_ = true;
  }
  for (std::size_t k = 0; k < channels_.size(); ++k) AdoptIn(k);
  if (!plain_) return;  // once not, for ever: links may hold samples
  plain_ = IsPlain();
  if (!plain_) MakeChannels();
}

bool Neighbours::IsPlain() const {
  const auto always_on = [](const AgentConfig& agent) {
    return agent.start_s == 0 && std::isinf(agent.stop_s) && !agent.faults.is_lost();
  };
  return experiment_->schedule.IsConstant() && experiment_->cut.empty() && experiment_->sensors.heard.IsNone() &&
         always_on(experiment_->agent(id_)) && !experiment_->agent(id_).faults.is_deaf &&
         std::ranges::all_of(may_hear_, [&](const Graph::Neighbour& neighbour) {
           return experiment_->links.Of(id_, neighbour.id).IsPerfect() && always_on(experiment_->agent(neighbour.id)) &&
                  !experiment_->agent(neighbour.id).lie && !experiment_->agent(neighbour.id).faults.is_mute &&
                  experiment_->agent(neighbour.id).faults.Of(FaultPart::kLink) == nullptr;
         });
}

std::span<const double> Neighbours::OfItsLaw(std::size_t k, std::int64_t tick, std::span<const double> message) const {
  const AgentConfig& sender = experiment_->agent(may_hear_[k].id);
  const std::int64_t since = std::max(sender.law.since, sender.faults.restarted);
  return since == 0 || tick >= since ? message : std::span<const double>();
}

void Neighbours::HearPlain(std::span<const Sample> samples) {
  for (std::size_t k = 0; k < may_hear_.size(); ++k) {
    const std::span<const double> message = OfItsLaw(k, tick_ - samples[k].message_age, samples[k].message);
    heard_.push_back({may_hear_[k].id, may_hear_[k].weight, *samples[k].motion, 0, message});
    ++early_counts_[k].sent;
    early_counts_[k].numbers += samples[k].message.size();
  }
}

double Neighbours::WeightOf(const Graph& graph, double t_s, int source) const {
  if (experiment_->cut.contains({id_, source})) return 0;
  const AgentConfig &sender = experiment_->agent(source), &self = experiment_->agent(id_);
  if (!IsOn(sender, t_s) || !IsOn(self, t_s) || sender.faults.is_mute || self.faults.is_deaf) return 0;
  const auto& heard = graph.HeardBy(id_);
  const auto edge = std::ranges::lower_bound(heard, source, {}, &Graph::Neighbour::id);
  return edge != heard.end() && edge->id == source ? edge->weight : 0;
}

std::span<const Heard> Neighbours::Hear(std::int64_t tick, const Motion& self, std::span<const Sample> samples) {
  assert(samples.size() == may_hear_.size());
  heard_.clear();
  tick_ = tick;
  if (plain_) {
    HearPlain(samples);
    return heard_;
  }
  const double t_s = experiment_->time_s(tick), range_m = experiment_->schedule.range_m();
  const Graph& graph = experiment_->schedule.At(t_s);
  for (std::size_t k = 0; k < may_hear_.size(); ++k) {
    const double weight = WeightOf(graph, t_s, may_hear_[k].id);
    const bool in_range = range_m == 0 || (samples[k].motion->p_WB - self.p_WB).norm() < range_m;
    edge_states_[k] = weight == 0 ? EdgeNow::State::kNoEdge
                      : in_range  ? EdgeNow::State::kLost
                                  : EdgeNow::State::kOutOfRange;
    const Sample said = SaidBy(k, tick, samples[k]);
    const bool is_sent = weight > 0 && in_range && (!channels_[k].faulty || channels_[k].faulty->Sends(tick));
    if (is_sent) channels_[k].link.Send(tick, weight, said);
    Deliver(k, tick);
  }
  return heard_;
}

Sample Neighbours::SaidBy(std::size_t k, std::int64_t tick, const Sample& truth) {
  const double t_s = experiment_->time_s(tick);
  Channel& channel = channels_[k];
  Sample said = truth;
  if (channel.false_data && channel.false_data->IsToldAt(t_s)) {
    false_motion_ = *truth.motion;
    false_message_.assign(truth.message.begin(), truth.message.end());
    channel.false_data->Tell(tick, t_s, false_motion_, false_message_);
    said = {&false_motion_, false_message_, truth.message_age};
  }
  return channel.faulty ? channel.faulty->SentFor(tick, said) : said;
}

void Neighbours::Deliver(std::size_t k, std::int64_t tick) {
  const Link::Packet* packet = channels_[k].link.Receive(tick);
  if (packet == nullptr) return;
  heard_.push_back({.id = may_hear_[k].id,
                    .weight = packet->weight,
                    .motion = packet->motion,
                    .age_s = experiment_->time_s(tick - packet->sent),
                    .message = OfItsLaw(k, packet->sent - packet->message_age, packet->message)});
  channels_[k].noise.AddTo(heard_.back().motion, packet->sent);
}

EdgeNow Neighbours::EdgeAt(std::size_t k) const {
  if (tick_ < 0) return {};
  if (plain_) return {EdgeNow::State::kHeard, 0};
  const Link::Packet* newest = channels_[k].link.newest();
  const double age_s = newest != nullptr ? experiment_->time_s(tick_ - newest->sent) : -1;
  if (std::ranges::binary_search(heard_, may_hear_[k].id, {}, &Heard::id)) return {EdgeNow::State::kHeard, age_s};
  const bool is_silent = newest == nullptr && edge_states_[k] == EdgeNow::State::kLost;
  return {is_silent ? EdgeNow::State::kNothingYet : edge_states_[k], age_s};
}

void Neighbours::AddEdgesTo(std::vector<EdgeNow>& edges) const {
  for (std::size_t k = 0; k < may_hear_.size(); ++k) edges.push_back(EdgeAt(k));
}

void Neighbours::AddLossesTo(std::vector<std::uint64_t>& lost) const {
  for (const Channel& channel : channels_) lost.push_back(channel.link.count().lost);
  if (plain_) lost.insert(lost.end(), may_hear_.size(), 0);
}

std::vector<EdgeCount> Neighbours::counts() const {
  std::vector<EdgeCount> counts = early_counts_;
  for (std::size_t k = 0; k < channels_.size(); ++k) counts[k] += channels_[k].link.count();
  return counts;
}

}  // namespace mascot
