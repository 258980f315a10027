#include "orchestrator/live/recorded/projector.h"

#include <exception>
#include <utility>

namespace mascot {
namespace {

constexpr auto kFramePeriod = std::chrono::milliseconds(33);
/// So many rows at a time are followed for the states of edges, so that a frame, and a new request, are not late.
constexpr int kRowsAtATime = 50;

}  // namespace

Projector::Projector(RecordedRun& run, Playback& playback, LiveView& view, std::function<void(const std::string&)> log)
    : run_(run), playback_(playback), view_(view), log_(std::move(log)), row_(run.experiment().size()) {
  view_.SetEvents(run.Events());
  thread_ = std::jthread([this](const std::stop_token& over) { Run(over); });
}

void Projector::Run(const std::stop_token& over) {
  std::optional<Playback::PlaybackState> shown;
  while (!over.stop_requested()) {
    const auto frame_ends = Playback::WallClock::now() + kFramePeriod;
    const Playback::PlaybackState now = playback_.Now();
    try {
      if (now != shown) Show(now);
      while (!has_edges_ && Playback::WallClock::now() < frame_ends && !over.stop_requested())
        if ((has_edges_ = FollowEdges())) Publish();
      FollowCurves(frame_ends);
    } catch (const std::exception& error) {
      log_(std::string("error: ") + error.what());
      playback_.Ask({.kind = Request::Kind::kPause});
      row_.tick = now.tick;  // not again
      has_edges_ = true;
    }
    shown = now;
    if (has_edges_ && run_.curves().is_whole())
      playback_.Wait(over, now.plays ? frame_ends : frame_ends + std::chrono::hours(1));
  }
}

void Projector::Show(const Playback::PlaybackState& now) {
  view_.SetState({.phase = now.plays ? RunState::Phase::kRunning : RunState::Phase::kPaused, .pace = now.speed});
  if (now.tick == row_.tick) return;
  run_.Show(now.tick, row_);
  has_edges_ = FollowEdges();
  Publish();
}

bool Projector::FollowEdges() try {
  return run_.FollowEdges(row_, kRowsAtATime);
} catch (const std::exception& error) {  // of an earlier tick
  if (!lacks_rows_) log_(std::string("warning: ") + error.what() + ": states of edges are not known from there on");
  lacks_rows_ = true;
  return true;
}

/// Goes on with the curves until the time of this frame is up.
void Projector::FollowCurves(Playback::WallClock::time_point until) {
  if (run_.curves().is_whole()) return;
  constexpr auto kBetween = std::chrono::seconds(1);
  try {
    while (!run_.curves().is_whole() && Playback::WallClock::now() < until) run_.FollowCurves(kRowsAtATime);
  } catch (const std::exception& error) {
    log_(std::string("warning: ") + error.what() + ": curves end there");
  }
  const auto now = Playback::WallClock::now();
  if (!run_.curves().is_whole() && now < curves_shown_ + kBetween) return;
  view_.SetCurves(run_.curves().curves());
  curves_shown_ = now;
}

void Projector::Publish() {
  const std::shared_ptr<const Experiment> now = run_.At(row_.tick);
  if (now != experiment_) view_.SetExperiment(*now, run_.KeysAt(row_.tick));
  experiment_ = now;
  view_.Take(row_);
}

}  // namespace mascot
