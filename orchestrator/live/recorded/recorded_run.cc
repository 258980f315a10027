#include "orchestrator/live/recorded/recorded_run.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "agent/laws/laws.h"
#include "orchestrator/live/recorded/incident_table.h"
#include "orchestrator/live/shown/shown_keys.h"
#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/recording/run_folder.h"

namespace mascot {

RecordedRun::RecordedRun(const std::string& run)
    : rows_(run),
      experiment_(LoadExperiment(Section::FromText(rows_.config(), rows_.path() + " (config.toml)"), rows_.name(),
                                 /*checked=*/true, UserCode::kNeverRuns)),
      incidents_(FirstIncidentsBeside(rows_.path())),
      events_(rows_.Events()),
      live_(std::in_place, experiment_, &LawTable(), /*checked=*/true),
      edges_(experiment_, last_tick(),
             {.read = [this](std::int64_t tick, DecodedRow& row) { rows_.Read(tick, row); },
              .adopted_at =
                  [this](std::int64_t tick) {
                    const std::size_t count = EventsUpTo(tick);
                    return count > EventsUpTo(tick - 1) ? StateAfter(count) : nullptr;
                  },
              .next_change = [this](std::int64_t tick) { return NextChange(tick); }}),
      curves_(experiment_, rows_.ticks(),
              {.read = [this](std::int64_t tick, DecodedRow& row) { rows_.Read(tick, row); },
               .at = [this](std::int64_t tick) { return At(tick); },
               .next_change = [this](std::int64_t tick) { return NextChange(tick); }}) {}

RecordedPart RecordedRun::part() const {
  const std::filesystem::path file = rows_.path(), folder = file.parent_path();
  return {.last_tick = last_tick(),
          .run = file.filename() == "run.mcap" && !folder.empty() ? folder.string() : file.string(),
          .loss = rows_.loss(),
          .incidents = incidents_,
          .pictures = PicturesIn(folder),
          .has_summary = std::filesystem::is_regular_file(folder / "summary.json")};
}

std::vector<ShownEvent> RecordedRun::Events() const {
  std::vector<ShownEvent> shown;
  for (const auto& [tick, number, toml] : events_) shown.push_back({.number = number, .tick = tick, .toml = toml});
  if (!shown.empty()) MarkManualEvents(rows_.path(), experiment_, shown);
  return shown;
}

std::size_t RecordedRun::EventsUpTo(std::int64_t tick) const {
  const auto later = std::ranges::upper_bound(events_, tick, {}, &IndexedRows::EventAt::tick);
  return static_cast<std::size_t>(later - events_.begin());
}

std::int64_t RecordedRun::NextChange(std::int64_t tick) const {
  const std::size_t count = EventsUpTo(tick);
  return count < events_.size() ? events_[count].tick : INT64_MAX;
}

std::shared_ptr<const Experiment> RecordedRun::StateAfter(std::size_t events) {
  if (events == 0) return nullptr;
  const auto taken = [this] { return static_cast<std::size_t>(live_->count()); };
  if (events < taken()) live_.emplace(marks_[events / kBetweenMarks]);
  while (taken() < events) {
    if (taken() == marks_.size() * kBetweenMarks) marks_.push_back(*live_);
    const auto& [tick, number, toml] = events_[taken()];
    live_->Take(EventFrom(tick, toml, experiment_.size(), "event " + std::to_string(number)));
  }
  return live_->now();
}

std::shared_ptr<const Experiment> RecordedRun::At(std::int64_t tick) {
  const std::size_t events = EventsUpTo(tick);
  return events == 0 ? std::shared_ptr<const Experiment>(std::shared_ptr<void>(), &experiment_) : StateAfter(events);
}

std::vector<ShownKey> RecordedRun::KeysAt(std::int64_t tick) {
  const std::size_t events = EventsUpTo(tick);
  if (events == 0) return ShownKeysOf(experiment_);
  StateAfter(events);
  return ShownKeysOf(*live_);
}

void RecordedRun::Show(std::int64_t tick, ShownRow& row) {
  row.edges.clear();
  rows_.Read(tick, row.decoded);
  row.tick = rows_.ticks().TickOf(rows_.ticks().RowAt(tick));
  row.disagreement_m = DisagreementOf(*At(row.tick), row.decoded.motions);
}

bool RecordedRun::FollowEdges(ShownRow& row, int rows) {
  if (experiment_.graph.edges() > kMaxEdgesShown) return true;
  return edges_.Follow(row.tick, rows, row.edges);
}

}  // namespace mascot
