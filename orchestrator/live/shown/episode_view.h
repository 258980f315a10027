#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/episodes.h"
#include "orchestrator/live/server/address.h"

namespace mascot {

/// Shows episodes on one page, one after the other, and lets viewers steer them: while they pause an episode, whoever
/// steps it waits.
class EpisodeView final : public EpisodeWitness {
 public:
  struct Options {
    LiveAddress at = {};
    /// Simulated seconds a second of an episode whose file has no run.pace; 0: as fast as it goes.
    double pace = 1;
    /// Asked while somebody waits: whether that may go on.
    std::function<bool()> may_wait = [] { return true; };
    /// Takes a line about a viewer that was dropped or refused, or why the view has ended, from any thread.
    std::function<void(const std::string&)> log = [](const std::string&) {};
  };

  /// Listens from now on, for the episode that will be one of `experiment`. Throws ConfigError, about `at`, if that
  /// cannot be, and std::invalid_argument for a pace that no run can have.
  EpisodeView(const Experiment& experiment, Options options);
  ~EpisodeView() override;

  /// Address of the page.
  const std::string& url() const { return url_; }
  /// Whether the page is gone, because no port could be had again.
  bool has_ended() const { return shown_ == nullptr; }

  std::vector<RowSink*> Begin(const Experiment& experiment) override;
  /// Returns false if a viewer has stopped the episode.
  bool Await(Episodes& episodes) override;
  void End(const EngineResult& result) override;

 private:
  struct Shown;
  /// Shows what is to be an episode of `experiment`, in the place of the one before.
  void Show(const Experiment& experiment);

  Options options_;
  std::string url_;
  std::unique_ptr<Shown> shown_;  // null: the view has ended
};

}  // namespace mascot
