#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "orchestrator/engines/episodes.h"
#include "orchestrator/engines/stepped_team.h"
#include "system/console.h"

namespace mascot {

/// Episodes over DDS: a run of processes each, which begins when its states are first awaited, flies in a thread of its
/// own (DdsEngine), and is paused between two steps.
class EpisodesOverDds final : public SteppedTeam {
 public:
  struct Options {
    Console& console;                   ///< what the processes say goes there
    EpisodeWitness* witness = nullptr;  ///< sees each episode that leaves its tick 0; null: nobody does
    std::function<bool()> may_go_on = [] { return true; };  ///< asked while it waits; false: it waits no longer
  };
  /// `text`, of the file at `path`, with `overrides`, is the experiment. What `options` refers to must outlive this
  /// object. Throws ConfigError.
  EpisodesOverDds(std::string text, std::string path, std::vector<Override> overrides, Options options);
  ~EpisodesOverDds() override;

  void Reset(std::vector<Override> changes) override;
  void AwaitStates() override;
  const Experiment& now() const override;
  std::int64_t tick() const override;
  const DecodedRow& row() const override;
  std::vector<int> HeardBy(int id) const override;
  bool is_over() const override;
  const std::string& failure() const override;
  void Take(const std::string& toml) override;
  void GoTo(std::int64_t tick, const std::function<bool()>& goes_on) override;
  bool Leave() override;

 private:
  class Run;
  void Give(int id, std::span<const double> action) override;
  void Finish();

  const Options options_;
  std::unique_ptr<Run> run_;  // null until its states are awaited
  bool is_stuck_ = false;     // the DDS library has not let go of a run
};

}  // namespace mascot
