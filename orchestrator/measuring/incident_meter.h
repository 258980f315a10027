#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/contacts.h"
#include "base/episode.h"
#include "base/pacing.h"
#include "experiment/experiment.h"
#include "orchestrator/measuring/link_meter.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Something that happened to a run, or that was done to it: a line of events.csv.
struct Incident {
  enum class Kind {
    kContact,            ///< `other` as Contact::other
    kRotorFailure,       ///< `other`: the rotor
    kNoSafeCommand,      ///< law.safety found no safe command within the limits
    kLateCommand,        ///< the command's tick had ended before it arrived; in real time only
    kLostSamples,        ///< `other`: the agent that sent them
    kAccelerationLimit,  ///< the law wanted more than the limit; so for the other limits
    kSpeedLimit,
    kTiltLimit,
    kRotorLimit,
    kEvent,    ///< an event of the file or by hand, or a phase of [[law.schedule]]
    kVehicle,  ///< something has happened to an agent's vehicle, as `words` say
  };
  Kind kind = Kind::kEvent;
  std::int64_t from = 0, to = 0;  ///< the first and the last tick
  /// At how many ticks from `from` to `to` it happened; for kLostSamples: number of samples.
  std::int64_t count = 1;
  int agent = 0;             ///< 1..N; 0: no agent in particular
  int other = 0;             ///< of kEvent: its number
  double speed_m_per_s = 0;  ///< of kContact: Contact::speed_m_per_s
  std::string toml = {};     ///< of kEvent: Event::Toml()
  std::string words = {};    ///< of kVehicle
  bool by_hand = false;      ///< for kEvent: the event was given by hand, and is not of the file
};

/// An event as events.csv has it: Event::Toml() without the line break at its end.
std::string_view EventInTable(std::string_view toml);

/// This many are reported one by one, besides contacts and rotor failures; further ones are only counted.
inline constexpr std::size_t kMaxIncidentsTold = 100'000;

struct Incidents {
  std::vector<Incident> told;      ///< in the order of their first ticks, then of kind, agent and other
  std::int64_t more = 0;           ///< number of incidents that are not reported, besides contacts
  std::int64_t more_contacts = 0;  ///< number of contacts that are not reported
};

/// Gathers the incidents of a run, row by row.
class IncidentMeter {
 public:
  explicit IncidentMeter(const Experiment& experiment);
  /// Adds the next tick. `links` must have the same row already.
  void Add(const FlownRow& row, const LinkMeter& links);
  void OnVehicle(const VehicleNews& news);
  /// All incidents up to the newest tick, with the contacts and the late commands of the run, which the physics server
  /// counts.
  Incidents Result(const Contacts& contacts, const std::vector<LateCommands>& late) const;

 private:
  void Note(Episode& open, Incident::Kind kind, int agent, int other, std::int64_t tick, std::int64_t times = 1);
  void NoteLimits(std::int64_t tick, const std::vector<Command>& commands);
  void NoteEvent(const DecodedRow::RowEvent& event);
  void NoteLosses(std::int64_t tick, const LinkMeter& links);
  void Close(Incident incident);

  static constexpr std::size_t kKinds = static_cast<std::size_t>(Incident::Kind::kEvent) + 1;
  const Experiment& experiment_;
  const std::int64_t gap_;                         // in ticks
  std::vector<std::array<Episode, kKinds>> open_;  // by id - 1, then by kind: limits
  std::vector<char> is_lost_;                      // by id - 1
  struct Edge {
    int hearer = 0, heard = 0;
    std::uint64_t lost = 0;
    Episode open = {};
  };
  std::vector<Edge> edges_;          // in LinkMeter's order; empty as long as nothing can be lost
  std::vector<std::uint64_t> lost_;  // by index in edges_: samples that the edge has lost so far; room for LossesSoFar
  std::int64_t tick_ = -1;           // the newest
  Incidents closed_;                 // not in order
};

}  // namespace mascot
