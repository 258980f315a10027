#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "orchestrator/live/recorded/playback.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "orchestrator/live/shown/live_view.h"

namespace mascot {

/// Shows viewers the ticks of a recording that playback asks for, in a thread of its own.
class Projector {
 public:
  /// All arguments must outlive this object; no other code may use `run` meanwhile. `log` takes a line about a damaged
  /// file. Where the file is damaged, playback pauses; behind that place the states of edges are not known, if they
  /// depend on all rows.
  Projector(RecordedRun& run, Playback& playback, LiveView& view, std::function<void(const std::string&)> log);

 private:
  void Run(const std::stop_token& over);
  void Show(const Playback::PlaybackState& now);
  bool FollowEdges();
  void FollowCurves(Playback::WallClock::time_point until);
  void Publish();

  RecordedRun& run_;
  Playback& playback_;
  LiveView& view_;
  const std::function<void(const std::string&)> log_;
  ShownRow row_;
  std::shared_ptr<const Experiment> experiment_;  // that viewers know
  bool has_edges_ = true;                         // row_.edges are known, or never will be
  bool lacks_rows_ = false;                       // edges cannot be followed everywhere: the file is damaged
  Playback::WallClock::time_point curves_shown_;  // how far the curves are known, viewers were told last
  std::jthread thread_;                           // last: it uses the others
};

}  // namespace mascot
