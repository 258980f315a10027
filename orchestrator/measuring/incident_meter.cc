#include "orchestrator/measuring/incident_meter.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace mascot {
namespace {

using Kind = Incident::Kind;

/// The incidents that an agent's command tells of.
constexpr std::pair<std::uint32_t, Kind> kFlags[] = {{kAccelerationLimited, Kind::kAccelerationLimit},
                                                     {kTiltLimited, Kind::kTiltLimit},
                                                     {kRotorLimited, Kind::kRotorLimit},
                                                     {kSpeedLimited, Kind::kSpeedLimit},
                                                     {kSafetyInfeasible, Kind::kNoSafeCommand}};

constexpr double kRounding = 1e-6;  // in ticks: 0.29 s at 100 Hz is tick 29

}  // namespace

std::string_view EventInTable(std::string_view toml) {
  if (toml.ends_with('\n')) toml.remove_suffix(1);
  return toml;
}

IncidentMeter::IncidentMeter(const Experiment& experiment)
    : experiment_(experiment),
      gap_(EpisodeGapTicks(experiment.control.rate_hz)),
      open_(experiment.agents.size()),
      is_lost_(experiment.agents.size()) {}

void IncidentMeter::Close(Incident incident) {
  if (closed_.told.size() < kMaxIncidentsTold)
    closed_.told.push_back(std::move(incident));
  else
    ++closed_.more;
}

void IncidentMeter::Note(Episode& open, Kind kind, int agent, int other, std::int64_t tick, std::int64_t times) {
  if (open.IsOver(tick, gap_)) {
    Close({kind, open.from, open.to, open.count, agent, other});
    open = {};
  }
  open.Add(tick, times);
}

void IncidentMeter::NoteLimits(std::int64_t tick, const std::vector<Command>& commands) {
  for (std::size_t i = 0; i < commands.size(); ++i)
    for (const auto& [flag, kind] : kFlags)
      if ((commands[i].flags & flag) != 0 && is_lost_[i] == 0)
        Note(open_[i][static_cast<std::size_t>(kind)], kind, static_cast<int>(i) + 1, 0, tick);
}

void IncidentMeter::NoteLosses(std::int64_t tick, const LinkMeter& links) {
  if (links.plain()) return;
  if (edges_.empty())
    for (const EdgeTraffic& edge : links.Result()) edges_.push_back({.hearer = edge.hearer, .heard = edge.heard});
  links.LossesSoFar(lost_);
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    Edge& edge = edges_[k];
    const std::uint64_t lost = std::exchange(edge.lost, lost_[k]);
    if (edge.lost > lost)
      Note(edge.open, Kind::kLostSamples, edge.hearer, edge.heard, tick, static_cast<std::int64_t>(edge.lost - lost));
  }
}

void IncidentMeter::Add(const FlownRow& row, const LinkMeter& links) {
  tick_ = row.tick();
  for (const DecodedRow::RowEvent& event : row.decoded().events) NoteEvent(event);
  NoteLimits(tick_, row.decoded().commands);
  NoteLosses(tick_, links);
}

void IncidentMeter::OnVehicle(const VehicleNews& news) {
  const std::int64_t tick = std::max<std::int64_t>(tick_, 0);
  Close({.kind = Kind::kVehicle, .from = tick, .to = tick, .agent = news.agent, .words = news.words});
}

void IncidentMeter::NoteEvent(const DecodedRow::RowEvent& event) {
  const auto& [number, what] = event;
  if (what.fault && what.fault->IsLoss()) is_lost_[static_cast<std::size_t>(what.fault->agent - 1)] = true;
  if (what.restart) is_lost_[static_cast<std::size_t>(*what.restart - 1)] = false;
  Close({.kind = Kind::kEvent, .from = tick_, .to = tick_, .other = number, .toml = what.Toml()});
}

Incidents IncidentMeter::Result(const Contacts& contacts, const std::vector<LateCommands>& late) const {
  IncidentMeter all = *this;
  const auto close = [&](const Episode& open, Kind kind, int agent, int other) {
    if (open.count > 0) all.Close({kind, open.from, open.to, open.count, agent, other});
  };
  for (std::size_t i = 0; i < open_.size(); ++i)
    for (std::size_t kind = 0; kind < kKinds; ++kind)
      close(open_[i][kind], static_cast<Kind>(kind), static_cast<int>(i) + 1, 0);
  for (const LateCommands& one : late) close(one.ticks, Kind::kLateCommand, one.agent, 0);
  for (const Edge& edge : edges_) close(edge.open, Kind::kLostSamples, edge.hearer, edge.heard);
  std::vector<Incident>& told = all.closed_.told;
  for (const RotorFailure& failure : experiment_.physics.rotor_failures)
    if (const auto tick = static_cast<std::int64_t>(std::floor(failure.at_s * experiment_.control.rate_hz + kRounding));
        tick <= tick_)
      told.push_back({Kind::kRotorFailure, tick, tick, 1, failure.agent, failure.rotor});
  for (const Contact& contact : contacts.first)
    told.push_back(
        {Kind::kContact, contact.tick, contact.tick, 1, contact.agent, contact.other, contact.speed_m_per_s});
  all.closed_.more_contacts = contacts.total() - static_cast<std::int64_t>(contacts.first.size());
  std::ranges::stable_sort(told, {}, [](const Incident& incident) {
    return std::tuple(incident.from, incident.kind, incident.agent, incident.other);
  });
  return std::move(all.closed_);
}

}  // namespace mascot
