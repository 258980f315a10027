#include "orchestrator/live/recorded_run.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "agent/laws.h"
#include "experiment/toml/utf8.h"
#include "orchestrator/measuring/agreement_meter.h"

namespace mascot {

namespace {

/// The first lines of the table of incidents beside the recording, as many as a page can mark; empty: there is none.
std::string IncidentsBeside(const std::string& recording) {
  constexpr std::size_t kMost = 1 << 17;  // bytes
  const std::filesystem::path path = std::filesystem::path(recording).replace_filename("events.csv");
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return "";
  std::string text(kMost, '\0');
  std::ifstream table(path, std::ios::binary);
  table.read(text.data(), std::ssize(text));
  text.resize(static_cast<std::size_t>(table.gcount()));
  if (text.size() == kMost) text.resize(text.find_last_of('\n') + 1);
  return Utf8(text);
}

}  // namespace

RecordedRun::RecordedRun(const std::string& run)
    : rows_(run),
      experiment_(LoadExperiment(Section::FromText(rows_.config(), rows_.path() + " (config.toml)"), rows_.name(),
                                 /*checked=*/true)),
      incidents_(IncidentsBeside(rows_.path())),
      events_(rows_.Events()),
      live_(experiment_, &LawTable(), /*checked=*/true),
      edges_(experiment_, last_tick(),
             {.read = [this](std::int64_t tick, DecodedRow& row) { rows_.Read(tick, row); },
              .adopted_at =
                  [this](std::int64_t tick) {
                    const std::size_t count = EventsUpTo(tick);
                    return count > EventsUpTo(tick - 1) ? StateAfter(count) : nullptr;
                  },
              .next_change =
                  [this](std::int64_t tick) {
                    const std::size_t count = EventsUpTo(tick);
                    return count < events_.size() ? events_[count].tick : INT64_MAX;
                  }}) {}

std::vector<ShownEvent> RecordedRun::Events() const {
  std::vector<ShownEvent> shown;
  for (const auto& [tick, event] : events_)
    shown.push_back({.number = event.number, .tick = tick, .toml = event.toml, .by_hand = false});
  return shown;
}

std::size_t RecordedRun::EventsUpTo(std::int64_t tick) const {
  const auto later = std::ranges::upper_bound(events_, tick, {}, &IndexedRows::EventAt::tick);
  return static_cast<std::size_t>(later - events_.begin());
}

std::shared_ptr<const Experiment> RecordedRun::StateAfter(std::size_t events) {
  while (states_.size() < events) {
    const auto& [tick, event] = events_[states_.size()];
    states_.push_back(live_.Take(tick, event.number, event.toml));
  }
  return events == 0 ? nullptr : states_[events - 1];
}

const Experiment& RecordedRun::At(std::int64_t tick) {
  const std::size_t events = EventsUpTo(tick);
  return events == 0 ? experiment_ : *StateAfter(events);
}

void RecordedRun::Show(std::int64_t tick, ShownRow& row) {
  row.edges.clear();
  rows_.Read(tick, row.decoded);
  row.tick = tick;
  row.disagreement_m = DisagreementOf(At(tick), row.decoded.motions);
}

bool RecordedRun::FollowEdges(ShownRow& row, int rows) {
  if (experiment_.graph.edges() > kMostEdgesShown) return true;
  return edges_.Follow(row.tick, rows, row.edges);
}

}  // namespace mascot
