#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/measuring/incident_meter.h"
#include "orchestrator/measuring/law_meters.h"
#include "orchestrator/measuring/link_meter.h"
#include "orchestrator/measuring/metrics.h"
#include "orchestrator/measuring/phase_meter.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Measures a run row by row: metrics, link traffic, and, for each phase of [[law.schedule]], how far its law's aim is
/// reached.
class RunMeter final : public RowSink {
 public:
  /// `crew`: as for Metrics.
  explicit RunMeter(const Experiment& experiment, Crew& crew = Crew::Alone());

  void Adopt(const LiveExperiment& live, std::span<const Event> events) override;
  void Add(const FlownRow& row) override;
  void OnVehicle(const VehicleNews& news) override;
  Measured Result() const { return metrics_.Result(); }
  /// The phases so far, in order; at least the first.
  const std::deque<PhaseMeter>& phases() const { return phases_; }
  /// What the laws have measured by the end of a phase, or by now.
  std::vector<LawMeasured> LawsOf(std::size_t phase) const;
  /// How far the aim of the newest phase is reached.
  Aim aim() const { return phases_.back().aim(); }
  std::vector<EdgeTraffic> Traffic() const { return links_.Result(); }
  void EdgesNow(std::vector<EdgeNow>& edges) const { links_.EdgesNow(edges); }
  /// The incidents of the run, with the contacts and the late commands that the physics server counted.
  Incidents IncidentsWith(const Contacts& contacts, const std::vector<LateCommands>& late) const {
    return incidents_.Result(contacts, late);
  }
  /// The curve of the team's law in the newest row (LawMeters::CurveOf).
  std::optional<double> curve() const { return laws_.CurveOf(EntryOf(now_ ? now_->law : experiment_.law)); }
  /// Disagreement in the newest row (m), for the progress line and for viewers.
  double disagreement_m() const { return phases_.back().disagreement_m(); }

 private:
  void Begin(const Experiment& now, std::int64_t tick, std::span<const Motion> motions);

  const Experiment& experiment_;
  std::shared_ptr<const Experiment> now_;  // null before the first event
  Metrics metrics_;
  LinkMeter links_;
  IncidentMeter incidents_;
  LawMeters laws_;
  std::deque<PhaseMeter> phases_;  // never empty
};

}  // namespace mascot
