#include "orchestrator/report/incident_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "orchestrator/formats/csv.h"
#include "orchestrator/report/text_line.h"

namespace mascot {
namespace {

using Kind = Incident::Kind;

/// How a kind is told, by Incident::Kind.
struct KindInWords {
  Kind kind;
  std::string_view name;      ///< in the table
  std::string_view happened;  ///< in the text; {0}: agent, {1}: with what, {2}: count, {3}: speed, {4}: plural s
};

constexpr std::array kKindsInWords = {
    KindInWords{Kind::kContact, "contact", "agent {0} touches {1} at {3:.3g} m/s"},
    KindInWords{Kind::kRotorFailure, "rotor_failure", "{1} of agent {0} fails"},
    KindInWords{Kind::kNoSafeCommand, "no_safe_command", "agent {0} has no safe command, at {2} tick{4}"},
    KindInWords{Kind::kLateCommand, "late_command", "commands of agent {0} come too late, for {2} tick{4}"},
    KindInWords{Kind::kLostSamples, "lost_samples", "agent {0} loses {2} sample{4} of {1}"},
    KindInWords{Kind::kAccelerationLimit, "acceleration_limit", "agent {0} at its acceleration limit, at {2} tick{4}"},
    KindInWords{Kind::kSpeedLimit, "speed_limit", "agent {0} at its speed limit, at {2} tick{4}"},
    KindInWords{Kind::kTiltLimit, "tilt_limit", "agent {0} at its tilt limit, at {2} tick{4}"},
    KindInWords{Kind::kRotorLimit, "rotor_limit", "agent {0} at the limit of a rotor, at {2} tick{4}"},
    KindInWords{Kind::kEvent, "event", ""},
    KindInWords{Kind::kVehicle, "vehicle", ""},  // the terminal has told it
};
static_assert(std::ranges::is_sorted(kKindsInWords, {}, &KindInWords::kind));

const KindInWords& WordsFor(Kind kind) { return kKindsInWords[static_cast<std::size_t>(kind)]; }

std::string WithWhat(const Incident& incident) {
  switch (incident.kind) {
    case Kind::kContact:
      return PartnerOf({.agent = incident.agent, .other = incident.other});
    case Kind::kRotorFailure:
      return fmt::format("rotor {}", incident.other);
    case Kind::kLostSamples:
      return fmt::format("agent {}", incident.other);
    case Kind::kEvent:
      return fmt::format("event {}{}", incident.other, incident.by_hand ? " by hand" : "");
    default:
      return "";
  }
}

std::string DetailOf(const Incident& incident) {
  if (incident.kind == Kind::kContact) return fmt::format("{} m/s", incident.speed_m_per_s);
  if (incident.kind == Kind::kVehicle) return incident.words;
  return std::string(EventInTable(incident.toml));
}

std::string TimeText(const Experiment& experiment, const Incident& incident) {
  const double from_s = experiment.time_s(incident.from), to_s = experiment.time_s(incident.to);
  return incident.from == incident.to ? fmt::format("{:g} s", from_s) : fmt::format("{:g} to {:g} s", from_s, to_s);
}

}  // namespace

std::string PartnerOf(const Contact& contact) {
  if (contact.other == Contact::kGround) return "ground";
  return contact.other > 0 ? fmt::format("agent {}", contact.other) : fmt::format("obstacle {}", -contact.other);
}

Incidents IncidentsOf(const RunMeter& meter, const EngineResult& engine, std::span<const int> by_hand) {
  Incidents all = meter.IncidentsWith(engine.contacts.value_or(Contacts()), engine.pacing.value_or(Pacing()).late);
  for (Incident& incident : all.told)
    incident.by_hand = incident.kind == Kind::kEvent && std::ranges::binary_search(by_hand, incident.other);
  return all;
}

std::string IncidentsCsv(const Experiment& experiment, const Incidents& incidents) {
  using TableRow = std::array<std::string, 7>;
  const auto time = [&](std::int64_t tick) { return fmt::format("{}", experiment.time_s(tick)); };
  std::string csv = CsvRow(TableRow{"t_s", "until_s", "what", "count", "agent", "with", "detail"});
  for (const Incident& incident : incidents.told)
    csv += CsvRow(TableRow{time(incident.from), time(incident.to), std::string(WordsFor(incident.kind).name),
                           std::to_string(incident.count), incident.agent > 0 ? std::to_string(incident.agent) : "",
                           WithWhat(incident), DetailOf(incident)});
  if (incidents.more > 0) csv += CsvRow(TableRow{"", "", "more", std::to_string(incidents.more), "", "", ""});
  return csv;
}

std::string IncidentsText(const Experiment& experiment, const Incidents& incidents) {
  std::array<const Incident*, kKindsInWords.size()> first{};
  std::array<std::int64_t, kKindsInWords.size()> counts{};
  for (const Incident& incident : incidents.told) {
    const auto kind = static_cast<std::size_t>(incident.kind);
    if (first[kind] == nullptr) first[kind] = &incident;
    ++counts[kind];
  }
  counts[static_cast<std::size_t>(Kind::kContact)] += incidents.more_contacts;
  std::string text;
  for (const KindInWords& words : kKindsInWords) {
    const auto kind = static_cast<std::size_t>(words.kind);
    if (first[kind] == nullptr || words.happened.empty()) continue;
    const Incident& incident = *first[kind];
    const std::string more = counts[kind] > 1 ? fmt::format("; {} more of this kind", counts[kind] - 1) : "";
    const bool is_ground = incident.kind == Kind::kContact && incident.other == Contact::kGround;
    text +=
        Line("{:<14} {}: {}{}", text.empty() ? "happened" : "", TimeText(experiment, incident),
             fmt::format(fmt::runtime(words.happened), incident.agent, is_ground ? "the ground" : WithWhat(incident),
                         incident.count, incident.speed_m_per_s, incident.count == 1 ? "" : "s"),
             more);
  }
  return text;
}

}  // namespace mascot
