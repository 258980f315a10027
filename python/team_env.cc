#include "python/team_env.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "agent/laws/laws.h"
#include "base/state_numbers.h"
#include "experiment/toml/section.h"
#include "orchestrator/engines/driven_agents.h"
#include "orchestrator/measuring/agreement_meter.h"

namespace mascot {
namespace {

constexpr std::size_t kSeeds = std::size_t{1} << 31;  // of episodes without a seed of their own
constexpr double kUnit = 1 + 1e-6;                    // components of unit quaternions, rounded
constexpr double kMaxWeight = 1e6;                    // of graph.edges
constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// AgentsThatAct(), of which there must be one.
std::vector<int> Drivable(const Experiment& experiment) {
  std::vector<int> ids = AgentsThatAct(experiment);
  if (ids.empty())
    throw ConfigError(
        {"expected agents that take actions, got none: the laws of the file, and what is set, decide for all"});
  return ids;
}

std::vector<double> ActionHigh(const AgentConfig& agent) {
  std::vector<double> high(agent.law.params->action, 1.0);
  const bool wants_velocity = WantedBy(agent.law) == Wanted::kVelocity;
  std::fill_n(high.begin(), 3,
              wants_velocity ? agent.control.max_speed_m_per_s : agent.control.max_acceleration_m_per_s2);
  return high;
}

/// Whether what some agent measures or says is not what the file's physics bounds.
bool MayBeAnything(const Experiment& experiment) {
  const auto spoils = [](const Event& event) {
    return event.fault && (event.fault->of == FaultPart::kSensor || event.fault->kind == FaultKind::kLie);
  };
  return std::ranges::any_of(experiment.agents, [](const AgentConfig& agent) { return agent.lie.has_value(); }) ||
         std::ranges::any_of(experiment.events, spoils);
}

/// More than errors that Gaussian noise has in the life of the universe.
double ErrorOf(double std, double bias_std) { return 20 * (std + bias_std); }

/// Bounds of what an agent observes. A body cannot fall, or be driven, for longer than the run. Bounds are twice that,
/// for drag of wind and shoves of others; starting places that are drawn lie within ten times those that were.
std::vector<double> ObservationHigh(const Experiment& experiment, const ObservationLayout& layout) {
  double place = 1, speed = 1, drive = 0;
  for (const AgentConfig& agent : experiment.agents) {
    place = std::max(place, agent.p_W.cwiseAbs().maxCoeff());
    speed = std::max(speed, agent.v_W.cwiseAbs().maxCoeff());
    drive = std::max(drive, std::sqrt(3) * agent.control.max_acceleration_m_per_s2);
    const bool wants_velocity = WantedBy(agent.law) == Wanted::kVelocity;
    if (wants_velocity || agent.traits().driven_by == Wanted::kVelocity)
      speed = std::max(speed, std::sqrt(3) * agent.control.max_speed_m_per_s);
  }
  const double time = experiment.run.duration_s;
  const double v = 10 * speed + 2 * (drive + experiment.physics.gravity_m_per_s2) * time;
  const double p = 10 * place + v * time;
  const NoiseConfig& own = experiment.sensors.own;
  const NoiseConfig& heard = experiment.sensors.heard;
  const double own_p = p + ErrorOf(own.position_std_m, own.position_bias_std_m);
  const double own_v = v + ErrorOf(own.velocity_std_m_per_s, own.velocity_bias_std_m_per_s);
  const double other_p = own_p + p + ErrorOf(heard.position_std_m, heard.position_bias_std_m);
  const double other_v = own_v + v + ErrorOf(heard.velocity_std_m_per_s, heard.velocity_bias_std_m_per_s);
  const bool anything = MayBeAnything(experiment);
  const auto vector = [&](double bound) { return std::vector<double>(3, anything ? kNowhere : bound); };

  std::vector<double> high;
  const auto add = [&](const std::vector<double>& bounds) { high.insert(high.end(), bounds.begin(), bounds.end()); };
  add(vector(own_p));
  add(vector(own_v));
  add(std::vector<double>(4, kUnit));
  for (std::size_t k = 0; k < layout.places; ++k) {
    add(vector(other_p));
    add(vector(other_v));
    add({kMaxWeight, 1, time});
    add(std::vector<double>(layout.message, kNowhere));
  }
  return high;
}

}  // namespace

TeamEnv::TeamEnv(const std::string& text, const std::string& path, std::vector<Override> overrides,
                 Episodes::Keeps keeps)
    : episodes_(text, path, WithDrivenTeam(text, path, std::move(overrides)), keeps) {
  ids_ = Drivable(experiment());
  for (const int id : ids_) {
    high_.push_back(ActionHigh(experiment().agent(id)));
    action_size_ = std::max(action_size_, high_.back().size());
  }
  layout_ = LayoutOf(experiment(), action_size_ - 3);
  observation_high_ = ObservationHigh(experiment(), layout_);
  observations_.resize(ids_.size() * layout_.size());
  agents_of_team_ = experiment().agents.size();
  Begin();
}

void TeamEnv::Begin() {
  const std::vector<int> ids = Drivable(experiment());
  bool fits = ids == ids_ && experiment().agents.size() == agents_of_team_ &&
              LayoutOf(experiment(), layout_.message) == layout_;
  for (std::size_t k = 0; fits && k < ids.size(); ++k)
    fits = experiment().agent(ids[k]).law.params->action == action_size(k);
  if (!fits) {
    episodes_.Finish();
    throw ConfigError({"expected an episode with the agents, actions and layout of the first, got others"});
  }
  observers_.clear();
  for (const int id : ids_) observers_.emplace_back(experiment(), id, layout_);
  is_lost_.assign(ids_.size(), 0);
  Look();
}

void TeamEnv::Reset(std::optional<std::uint64_t> seed, std::optional<std::vector<Override>> sets) {
  std::vector<Override> next_sets = sets ? std::move(*sets) : sets_;
  std::optional<Random> next_seeds = seeds_;
  std::vector<Override> changes = next_sets;
  if (!seed && next_seeds)
    seed = next_seeds->Below(kSeeds);
  else if (seed)
    next_seeds.emplace(*seed, Random::Stream::kEpisodes);
  if (seed) changes.push_back({.key = "run.seed", .value = std::to_string(*seed), .origin = "seed"});
  episodes_.Reset(std::move(changes));
  if (!next_seeds) next_seeds.emplace(this->seed(), Random::Stream::kEpisodes);
  Begin();
  sets_ = std::move(next_sets);
  seeds_ = next_seeds;
}

void TeamEnv::Step(std::span<const double> actions, std::span<const char> given) {
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    if (!given[k] || is_lost(k) || episodes_.now().agent(ids_[k]).law.params->action == 0) continue;
    episodes_.Act(ids_[k], actions.subspan(k * action_size_, action_size(k)));
  }
  Step();
}

void TeamEnv::Step() {
  episodes_.Step();
  Look();
}

void TeamEnv::Look() {
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    const Agent& agent = episodes_.agent(ids_[k]);
    is_lost_[k] = is_lost(k) || agent.is_lost();
    if (is_lost(k)) continue;
    observers_[k].Observe(agent.measured(), agent.heard(),
                          std::span(observations_).subspan(k * layout_.size(), layout_.size()));
  }
}

void TeamEnv::StateTo(std::span<double> to) const {
  for (const Motion& motion : episodes_.row().motions) {
    mascot::StateTo(motion, to.first<kStateNumbers>());
    to = to.subspan(kStateNumbers);
  }
}

double TeamEnv::disagreement_m() const { return DisagreementOf(episodes_.now(), episodes_.row().motions); }

std::string TeamEnv::Record(const std::optional<std::string>& out, bool force, const RunFolder::Words& words) {
  if (record_ != nullptr && !record_->is_complete())
    throw ConfigError({"expected one recording at a time, got another one before the episode of the last is over"});
  auto record = std::make_unique<EpisodeRecord>(out, experiment(), force, words);
  record_.swap(record);
  TellWitnesses();
  return record_->folder().string();
}

std::string TeamEnv::View(const EpisodeView::Options& options) {
  if (view_ != nullptr && !view_->has_ended())
    throw ConfigError({"expected one page at a time, got another one beside " + view_->url()});
  view_ = std::make_unique<EpisodeView>(experiment(), options);
  TellWitnesses();
  return view_->url();
}

void TeamEnv::Close() {
  Finish();
  view_.reset();
  TellWitnesses();
}

void TeamEnv::TellWitnesses() {
  std::vector<EpisodeWitness*> witnesses;  // who records comes first: viewers may make all others wait
  if (record_ != nullptr) witnesses.push_back(record_.get());
  if (view_ != nullptr) witnesses.push_back(view_.get());
  episodes_.SetWitnesses(std::move(witnesses));
}

void TeamEnv::Restore(const Episodes::Snapshot& snapshot) {
  episodes_.Restore(snapshot, [this] {
    if (episodes_.tick() == 0)
      Begin();
    else
      Look();
  });
}

}  // namespace mascot
